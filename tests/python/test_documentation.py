"""The documentation's JSON and commands.

The words after a block's language are its rule, and what the rule has to know: `json capture`.
"""

import json
import re
import shlex
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

import pytest
from markdown_it import MarkdownIt
from PIL import Image
from pydantic import TypeAdapter
from typer.core import TyperGroup
from typer.main import get_command
from typer.testing import CliRunner

from precompute.acquisition.capture import read_capture
from precompute.cli import app
from precompute.foils.distribution import GratingDistribution
from precompute.maps import Map, Sidecar
from precompute.recipes import Recipe, read_grating_recipe

ROOT = Path(__file__).parents[2]
GENERATED = ROOT / "docs" / "api"
PAGES = [
    *ROOT.glob("*.md"),
    *(page for page in ROOT.glob("docs/**/*.md") if GENERATED not in page.parents),
    *ROOT.glob("tests/scenes/*.md"),
]


@dataclass(frozen=True)
class Block:
    page: Path
    line: int
    language: str
    rule: str
    settings: dict[str, str]
    code: str

    def __str__(self) -> str:
        return f"{self.page.relative_to(ROOT)}:{self.line}"


def blocks_of(page: Path) -> list[Block]:
    found = []
    for token in MarkdownIt().parse(page.read_text("utf-8")):
        if token.type == "fence" and token.map is not None:
            words = token.info.split()
            language, rule = [*words, "", ""][:2]
            settings = dict(word.split("=", 1) for word in words[2:])
            found.append(Block(page, token.map[0] + 2, language, rule, settings, token.content))
    return found


BLOCKS = [block for page in PAGES for block in blocks_of(page)]
# Their schemas are checked in tests/web/gltf-extension.test.ts.
OURS = [block for block in BLOCKS if block.rule != "gltf"]


def of(language: str, *rules: str):
    chosen = [b for b in OURS if b.language == language and (not rules or b.rule in rules)]
    return pytest.mark.parametrize("block", chosen, ids=str)


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder to work in like the repository, which keeps its own maps whatever is written."""
    baked = tmp_path / "maps" / "baked"
    baked.mkdir(parents=True)
    names = ("pyproject.toml", "tests", "maps/captures", "maps/recipes")
    files = (file.relative_to(ROOT) for file in (ROOT / "maps" / "baked").iterdir())
    for path in (*map(Path, names), *files):
        (tmp_path / path).symlink_to(ROOT / path, (ROOT / path).is_dir())
    monkeypatch.chdir(tmp_path)
    return tmp_path


def written(block: Block, folder: Path) -> Path:
    file = folder / block.settings.get("file", "block.json")
    file.write_text(block.code, "utf-8")
    return file


# Rules


@of("json")
def test_json_is_what_it_stands_for(block: Block, folder: Path) -> None:
    file = written(block, folder)
    match block.rule:
        case "evaluation":
            read_grating_recipe(file)
        case "distribution":
            GratingDistribution.read(file)
        case "capture":
            read_capture(file, "flash")
        case "sidecar":
            shown = Sidecar.read(file).model_dump(exclude={"error"})
            name = shown["arrays"]["efficiency"]["file"].split(".")[0]
            real = Sidecar.read(ROOT / "maps" / "baked" / f"{name}.json").model_dump(
                exclude={"error"}
            )
            for sidecar in (shown, real):
                del sidecar["arrays"]["efficiency"]["sha256"]
            assert shown == real
        case "edited":
            shown = json.loads(block.code)
            assert edited_by(shown["edits"], shown["from"]["map"], folder) == shown
        case other:
            pytest.fail(f"no rule {other!r}")


def edited_by(edits: list[dict[str, object]], start: str, folder: Path) -> dict[str, object]:
    """What the sidecar tells of edits that are made anew, but for the checksum of a picture."""
    draw_leaf(folder / "leaf.png")
    lines = []
    for edit in edits:
        fields = {k: v for k, v in edit.items() if k not in ("kind", "sha256")}
        lines.append(
            " ".join([str(edit["kind"]), *(f"{k}={as_typed(v)}" for k, v in fields.items())])
        )
    run(
        [
            "edit",
            f"maps/baked/{start}",
            "-o",
            "edited",
            *(w for line in lines for w in ("-e", line)),
        ]
    )
    recipe = Map.read(folder / "edited.json").recipe
    told, given = recipe["edits"], edits
    for made, shown in zip(told, given, strict=True):
        if "sha256" in made:
            made["sha256"] = shown["sha256"]
    recipe["from"]["recipe"] = {
        k: v for k, v in recipe["from"]["recipe"].items() if k in ("kind", "design")
    }
    return recipe


def as_typed(value: object) -> object:
    return str(value).lower() if isinstance(value, bool) else value


@of("jsonl")
def test_each_line_is_a_recipe(block: Block) -> None:
    assert block.rule == "recipe"
    adapter = TypeAdapter(Recipe)
    for line in block.code.splitlines():
        adapter.validate_json(line)


# Commands


def commands_in(block: Block) -> list[list[str]]:
    """Words of each line; of a synopsis with all that may be left out, and without dots."""
    lines = block.code.splitlines()
    if block.rule == "parse":
        lines = [re.sub(r" …|[][]", "", line) for line in lines]
    return [words for line in lines if (words := shlex.split(line, comments=True))]


def run(words: list[str]) -> None:
    result = CliRunner().invoke(app, words, catch_exceptions=False)
    assert result.exit_code == 0, result.output


def parse(words: list[str]) -> None:
    """Follow the words down to a command and have it read the rest; nothing is run.

    Raises:
        Exception: typer's, which says what it does not know.
    """
    command, name, rest = get_command(app), "diffraction", words
    while isinstance(command, TyperGroup):
        assert rest and rest[0] in command.commands, f"{name} has no command {rest[:1]}"
        name, command, rest = rest[0], command.commands[rest[0]], rest[1:]
    command.make_context(name, list(rest))


def expect_npm_knows(words: list[str]) -> None:
    package = json.loads((ROOT / "package.json").read_text("utf-8"))
    match words:
        case ["run", script, *_]:
            assert script in package["scripts"], f"npm has no script {script}"
        case ["test", *checks]:
            script = (ROOT / "scripts" / "test.mjs").read_text("utf-8")
            names = re.findall(r"name: '([^']+)'", script)
            for word in checks[1:]:
                assert any(word in name for name in names), f"no check has {word} in its name"
        case ["install", *names]:
            assert set(names) <= {package["name"], *package["peerDependencies"]}
        case _:
            pytest.fail(f"npm {' '.join(words)} is not known here")


def expect_script_knows(words: list[str]) -> None:
    source = (ROOT / words[0]).read_text("utf-8")
    for option in words[1:]:
        if option.startswith("--"):
            assert re.search(rf"\b{option[2:]}: \{{ type:", source), f"{words[0]} has no {option}"


def expect_vitest_runs(words: list[str]) -> None:
    match words:
        case ["vitest", "run", "--project", project, file, *_]:
            assert file.startswith(f"tests/{project}/")
            assert (ROOT / file).is_file()
        case _:
            pytest.fail(f"npx {' '.join(words)} is not known here")


@of("sh")
def test_commands_are_there(block: Block) -> None:
    assert block.rule in ("run", "node", "parse")
    commands = commands_in(block)
    assert commands
    for program, *words in commands:
        match program:
            case "diffraction":
                parse(words)
            case "npm":
                expect_npm_knows(words)
            case "node":
                expect_script_knows(words)
            case "npx":
                expect_vitest_runs(words)
            case "python":
                assert words[:2] == ["-m", "pytest"]
                assert (ROOT / words[2]).is_file()
            case other:
                pytest.fail(f"{other} is not known here")


@of("sh", "run")
def test_commands_run(block: Block, folder: Path) -> None:
    """Beside the files that the page shows, and pictures that it takes for granted.

    With `share` captures are drawn at that share of their size, and at a few wavelengths.
    """
    for other in BLOCKS:
        if other.page == block.page and "file" in other.settings:
            written(other, folder)
    if "with" in block.settings:
        draw_leaf(folder / block.settings["with"])
    if "share" in block.settings:
        shrink_captures(folder, float(block.settings["share"]))
    for program, *words in commands_in(block):
        if program == "python":
            subprocess.run([sys.executable, *words], check=True)
        else:
            assert program == "diffraction"
            run(words)


@pytest.mark.parametrize("block", [b for b in BLOCKS if "file" in b.settings], ids=str)
def test_files_are_read_by_a_command(block: Block) -> None:
    commands = [b.code for b in BLOCKS if b.page == block.page and b.rule == "run"]
    assert any(block.settings["file"] in code for code in commands)


def shrink_captures(folder: Path, share: float) -> None:
    """A copy of the captures by flash in the place of the link to them."""
    captures = folder / "maps" / "captures"
    captures.unlink()
    captures.mkdir()
    for file in (ROOT / "maps" / "captures").glob("flash-*.json"):
        recipe = json.loads(file.read_text("utf-8"))
        recipe["size_px"] = [round(share * side) for side in recipe["size_px"]]
        recipe["camera"]["focal_px"] *= share
        recipe |= {"step_nm": 20, "subpixels": 1}
        (captures / file.name).write_text(json.dumps(recipe), "utf-8")


def draw_leaf(file: Path) -> None:
    """A light disc on black."""
    picture = Image.new("L", (64, 64))
    picture.paste(255, (16, 8, 48, 56))
    picture.save(file)


@pytest.mark.parametrize(
    ("line", "why"),
    [
        ("bake", "Missing parameter: recipes"),
        ("bakes X.json", "no command"),
        ("acquire CAPTURE.json", "no command"),
        ("edit MAP -o NAME --edits x", "No such option"),
        ("inspect MAP --output", "requires an argument"),
    ],
)
def test_wrong_commands_are_seen(line: str, why: str) -> None:
    with pytest.raises(Exception, match=why):
        parse(shlex.split(line))
