"""The command `diffraction`."""

from __future__ import annotations

import csv
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Annotated, Literal, TextIO

import rich.progress
import typer
from rich.console import Console

from precompute.errors import InputError, unreadable
from precompute.files import written_aside
from precompute.methods import Method
from precompute.progress import console, tracked

app = typer.Typer(no_args_is_help=True, add_completion=False, pretty_exceptions_enable=False)

design = typer.Typer(no_args_is_help=True, help="Design a foil from what was measured.")
app.add_typer(design, name="design")
acquire = typer.Typer(no_args_is_help=True, help="Make a foil's map from photographs.")
app.add_typer(acquire, name="acquire")
simulate = typer.Typer(no_args_is_help=True, help="Simulate photographs of a foil.")
app.add_typer(simulate, name="simulate")


@app.callback()
def main() -> None:
    """Precompute, check and report diffraction for three-diffraction."""


@contextmanager
def one_line_errors(
    draw: Callable[[InputError], InputError] = lambda error: error,
) -> Iterator[None]:
    """Bad input ends the command with its one line and exit code 2.

    Args:
        draw: Takes the error and returns it with the name of a picture, if there is one to draw.
    """
    try:
        yield
    except InputError as error:
        console.print(str(draw(error)), style="red", markup=False, soft_wrap=True)
        raise typer.Exit(2) from error


@app.command()
def bake(
    recipes: Annotated[list[Path], typer.Argument(help="Recipes (JSON).")],
    output: Annotated[Path, typer.Option("--output", "-o", help="Folder of the maps.")] = Path(
        "maps/baked"
    ),
) -> None:
    """Bake recipes into maps: a sidecar NAME.json and its binaries for each."""
    from precompute.bake import bake as bake_recipe

    with one_line_errors():
        files = [file for r in tracked(recipes, "Baking") for file in bake_recipe(r, output)]
        maps = sum(file.suffix == ".json" for file in files)
        total = sum(file.stat().st_size for file in files)
        console.print(f"{maps} maps, {total / 1024:.0f} KiB, in {output}")


@app.command()
def inspect(
    files: Annotated[
        list[Path],
        typer.Argument(
            metavar="MAP",
            help="Maps, with or without .json, or recipes of height fields.",
        ),
    ],
    output: Annotated[
        Path | None,
        typer.Option("--output", "-o", help="Folder for pictures: of a map's arrays, of a field."),
    ] = None,
) -> None:
    """Say what is in a map, and verify its checksums, or in a height field; with -o, draw it."""
    from precompute import inspection
    from precompute.height_fields import inspection as field_inspection

    with one_line_errors():
        for file in files:
            field = field_inspection.field_of_recipe(file)
            if field is None:
                text = inspection.description(file)
            else:
                text = field_inspection.description(field, file.stem)
            Console().print(text)
            if output is None:
                continue
            if field is None:
                pictures = inspection.write_pictures(file, output)
            else:
                pictures = field_inspection.write_pictures(field, file.stem, output)
            for picture in pictures:
                console.print(str(picture), markup=False, soft_wrap=True)


@app.command()
def evaluate(
    recipe: Annotated[Path, typer.Argument(metavar="RECIPE.json", help="Of kind grating.")],
    directions: Annotated[
        Path,
        typer.Argument(
            metavar="INPUT.csv",
            help="Columns wi_x, wi_y, wi_z, wo_x, wo_y, wo_z and, for the BRDF instead of its "
            "colour, wavelength_um; with --orders theta_i_deg, phi_i_deg, wavelength_um.",
        ),
    ],
    orders: Annotated[
        bool, typer.Option("--orders", help="The efficiencies of the orders that propagate.")
    ] = False,
    method: Annotated[Method | None, typer.Option(help="In place of the recipe's own.")] = None,
    output: Annotated[
        Path | None, typer.Option("--output", "-o", help="A file, in place of standard output.")
    ] = None,
) -> None:
    """Ask the reference or a method: BRDF, colour or order efficiencies at given directions."""
    from precompute.evaluate import evaluate as pieces_of
    from precompute.recipes import read_grating_recipe

    with one_line_errors():
        asked = read_grating_recipe(recipe)
        if method is not None:
            asked = asked.model_copy(update={"method": method})
        with _lines_with_progress(directions) as lines:
            pieces = pieces_of(asked, recipe.parent, directions, lines, orders)
            rows = (row for piece in pieces for row in piece)
            if output is None:
                csv.writer(sys.stdout, lineterminator="\n").writerows(rows)
            else:
                with written_aside(output) as aside, aside.open("w", encoding="utf-8") as file:
                    csv.writer(file, lineterminator="\n").writerows(rows)


@app.command()
def edit(
    foil: Annotated[Path, typer.Argument(metavar="MAP", help="Of kind foil.")],
    output: Annotated[
        Path, typer.Option("--output", "-o", metavar="NAME", help="The map, with its folder.")
    ],
    edits: Annotated[
        list[str],
        typer.Option(
            "--edit",
            "-e",
            metavar="EDIT",
            help="period, mask, crop, repeat, rotate, rescale, offset or bumps with its fields, as "
            "in 'rotate degrees=90'; one after the other. See docs/map-format.md.",
        ),
    ],
) -> None:
    """Make a foil of a foil: NAME.json, whose recipe tells the edits, and its images."""
    from precompute.foils.edit_lines import parsed
    from precompute.foils.edits import edited_map
    from precompute.maps import Map, sidecar_file

    with one_line_errors():
        lines = [parsed(line) for line in edits]
        edited = edited_map(Map.read(foil), sidecar_file(foil), lines, Path())
        for file in edited.write(output.parent, output.name.removesuffix(".json")):
            console.print(str(file), markup=False, soft_wrap=True)


@simulate.command("flash")
def simulate_flash(
    recipe: Annotated[Path, typer.Argument(metavar="RECIPE.json", help="Of kind flash-capture.")],
    output: Annotated[
        Path,
        typer.Option("--output", "-o", help="Where a folder named as the recipe is made."),
    ] = Path("captures"),
) -> None:
    """Photographs of a foil by flash, from the float64 reference, with the truth beside them."""
    from precompute.acquisition.simulate import simulate_flash as simulated

    with one_line_errors():
        console.print(str(simulated(recipe, output)), markup=False, soft_wrap=True)


@simulate.command("polarization")
def simulate_polarization(
    recipe: Annotated[
        Path, typer.Argument(metavar="RECIPE.json", help="Of kind polarization-capture.")
    ],
    output: Annotated[
        Path,
        typer.Option("--output", "-o", help="Where a folder named as the recipe is made."),
    ] = Path("captures"),
) -> None:
    """Photographs of a foil in polarised light, by Jones calculus, with the truth beside them."""
    from precompute.acquisition.simulate_polarization import simulate_polarization as simulated

    with one_line_errors():
        console.print(str(simulated(recipe, output)), markup=False, soft_wrap=True)


CaptureFile = Annotated[
    Path, typer.Argument(metavar="CAPTURE.json", help="See docs/acquisition.md.")
]
MapName = Annotated[
    Path, typer.Option("--output", "-o", metavar="NAME", help="The map, without extension.")
]
Debug = Annotated[
    Path | None, typer.Option(metavar="DIR", help="Folder for pictures of every step.")
]


@acquire.command("flash")
def acquire_flash(
    capture: CaptureFile,
    output: MapName,
    size: Annotated[
        tuple[int, int] | None,
        typer.Option(help="Columns and rows of the map.", show_default="as the photographs"),
    ] = None,
    height: Annotated[
        float, typer.Option(help="Of the gratings, µm: photographs do not tell it.")
    ] = 0.15,
    periods: Annotated[
        Literal["auto", "one", "many"], typer.Option(help="Of the gratings; auto finds out.")
    ] = "auto",
    method: Annotated[
        Literal["lobes", "thresholds"],
        typer.Option(help="lobes fits gratings; thresholds is the 2018 paper's method."),
    ] = "lobes",
    align: Annotated[bool, typer.Option(help="Move tiles to where the pattern is.")] = True,
    debug: Debug = None,
) -> None:
    """A foil's map from flash photographs: NAME.json, its images and NAME.report.json.

    Of a foil whose gratings are strewn (sample.stochastic) NAME.json is their distribution, which
    `diffraction design stochastic` takes.
    """
    from precompute.acquisition.capture import read_capture
    from precompute.acquisition.flash import FlashOptions
    from precompute.acquisition.flash import acquire_flash as acquired_from
    from precompute.acquisition.pictures import write_pictures
    from precompute.acquisition.stochastic_report import acquire_stochastic

    draw = _drawing(output, debug)
    with one_line_errors(draw):
        told = read_capture(capture, "flash")
        if told.sample.stochastic:
            way = "deconvolution" if method == "lobes" else "threshold"
            acquire_stochastic(told, capture.parent, output, _remark, height, way, draw)
            return
        is_one = {"auto": None, "one": True, "many": False}[periods]
        options = FlashOptions(size, height, is_one, method, align)
        acquired = acquired_from(capture, options, _remark, draw)
        acquired.foil.write(output.parent, output.name)
        acquired.report.write(output.parent / f"{output.name}.report.json")
        for line in acquired.report.lines():
            console.print(line, markup=False, soft_wrap=True)
        if debug is not None:
            write_pictures(acquired, debug)


@acquire.command("polarization")
def acquire_polarization(
    capture: CaptureFile,
    output: MapName,
    size: Annotated[
        tuple[int, int] | None,
        typer.Option(help="Columns and rows of the map.", show_default="as the photographs"),
    ] = None,
    height: Annotated[
        float, typer.Option(help="Of the gratings, µm: photographs do not tell it.")
    ] = 0.15,
    offset: Annotated[
        float | None,
        typer.Option(metavar="DEG", help="Of orientations from half of phases; 0 without it."),
    ] = None,
    period: Annotated[float | None, typer.Option(help="Of all gratings, µm.")] = None,
    periods: Annotated[
        tuple[float, float] | None,
        typer.Option(help="Shortest and longest, µm, told by brightness: a heuristic."),
    ] = None,
    passes: Annotated[
        int, typer.Option(help="Of a filter that takes noise and bumps out of orientations.")
    ] = 3,
    scheduler: Annotated[
        str | None,
        typer.Option(
            metavar="ADDRESS",
            help="Of a Dask cluster's scheduler: fits and filters there instead of in threads.",
        ),
    ] = None,
    debug: Debug = None,
) -> None:
    """A foil's map from photographs through a turning polariser, and NAME.report.json."""
    from math import radians

    from precompute.acquisition.blocks import running
    from precompute.acquisition.polarization import PolarizationOptions
    from precompute.acquisition.polarization import acquire_polarization as acquired_from
    from precompute.acquisition.polarization_pictures import write_pictures

    draw = _drawing(output, debug)
    with one_line_errors(draw):
        if period is not None and periods is not None:
            raise InputError("options", "period", period, "--period or --periods, not both")
        told = (period, period) if period is not None else periods
        turn = None if offset is None else radians(offset)
        options = PolarizationOptions(size, height, turn, told, passes)
        with running(scheduler) as run:
            acquired = acquired_from(capture, options, _remark, run)
        acquired.foil.write(output.parent, output.name)
        acquired.report.write(output.parent / f"{output.name}.report.json")
        for line in acquired.report.lines():
            console.print(line, markup=False, soft_wrap=True)
        if debug is not None:
            write_pictures(acquired, debug)


@acquire.command("fuse")
def acquire_fuse(
    map_file: Annotated[
        Path, typer.Argument(metavar="MAP.json", help="A foil's, of acquire polarization.")
    ],
    capture: Annotated[
        Path, typer.Argument(metavar="CAPTURE.json", help="Flash photographs of the same foil.")
    ],
    output: MapName,
) -> None:
    """A map from polarised light made absolute by a flash photograph of the same foil."""
    from math import degrees

    from precompute.acquisition.fuse import acquire_fused

    draw = _drawing(output, None)
    with one_line_errors(draw):
        foil, fusion = acquire_fused(map_file, capture, _remark, draw)
        foil.write(output.parent, output.name)
        console.print(
            f"orientations + {degrees(fusion.offset):.2f} degrees, periods × {fusion.scale:.4g}, "
            f"correlation {fusion.correlation:.2f}",
            markup=False,
            soft_wrap=True,
        )


def _drawing(output: Path, debug: Path | None) -> Callable[[InputError], InputError]:
    """Draws what errors saw, beside the output or among the pictures of every step."""
    from precompute.acquisition.refusal_pictures import drawn

    if debug is None:
        return lambda error: drawn(error, output.parent, f"{output.name}.")
    return lambda error: drawn(error, debug, "")


def _remark(text: str) -> None:
    console.print(text, style="yellow", markup=False, soft_wrap=True)


@app.command()
def report(
    scene: Annotated[
        list[str] | None, typer.Option(help="A scene's name; may be repeated. All without it.")
    ] = None,
    output: Annotated[
        Path | None,
        typer.Option(
            "--output",
            "-o",
            help="Folder of the report: docs/report, for chosen scenes tests/output/report.",
        ),
    ] = None,
    acquisition: Annotated[
        bool,
        typer.Option(
            "--acquisition",
            help="Only what is acquired from photographs, in a report that is there.",
        ),
    ] = False,
) -> None:
    """Measure error against run time in Chromium: report.json, index.md and pictures."""
    from precompute.report.browser import ROOT, BrowserError
    from precompute.report.run import SCENES, make_report, renew_acquisition
    from precompute.report.scenes import read_scenes

    folder = output or ROOT / ("tests/output/report" if scene else "docs/report")
    with one_line_errors():
        if acquisition:
            made = renew_acquisition(folder, console)
            message = f"{len(made.acquisition)} rows in {folder / 'acquisition.md'}"
            console.print(message, markup=False, soft_wrap=True)
            return
        try:
            made = make_report(read_scenes(SCENES, scene), folder, console)
        except BrowserError as error:
            console.print(str(error), style="red", markup=False, soft_wrap=True)
            raise typer.Exit(1) from error
    message = f"{len(made.rows)} rows in {folder / 'index.md'}"
    console.print(message, markup=False, soft_wrap=True)


@design.command()
def stochastic(
    distribution: Annotated[
        Path,
        typer.Argument(
            metavar="DISTRIBUTION.json", help="How often which orientations and periods occur."
        ),
    ],
    output: Annotated[
        Path, typer.Option("--output", "-o", metavar="NAME", help="The map, with its folder.")
    ],
    shape: Annotated[
        str | None, typer.Option(help="discs, squares, polygons or mask; squares without it.")
    ] = None,
    mask: Annotated[Path | None, typer.Option(help="PNG of the shape mask.")] = None,
    shape_mm: Annotated[float | None, typer.Option(help="Size of a shape, mm.")] = None,
    cover: Annotated[
        float | None, typer.Option(help="How many times over shapes would cover the tile.")
    ] = None,
    size: Annotated[int | None, typer.Option(help="Texels along a side of the tile.")] = None,
    tile_mm: Annotated[float | None, typer.Option(help="Side of the tile, mm.")] = None,
    height: Annotated[float | None, typer.Option(help="Of the gratings, um.")] = None,
    profile: Annotated[str | None, typer.Option(help="Of the gratings; a baked one.")] = None,
    seed: Annotated[int | None, typer.Option(help="Of the random arrangement.")] = None,
) -> None:
    """Strew shapes whose gratings are drawn from a distribution: a map NAME.json and its PNG."""
    from precompute.foils.stochastic import design_from_file

    options = {
        "shape": shape,
        "mask": mask,
        "shape_mm": shape_mm,
        "cover": cover,
        "size": size,
        "tile_mm": tile_mm,
        "height": height,
        "profile": profile,
        "seed": seed,
    }
    with one_line_errors():
        stated = {name: value for name, value in options.items() if value is not None}
        foil = design_from_file(distribution, stated)
        for file in foil.write(output.parent, output.name.removesuffix(".json")):
            console.print(str(file), markup=False, soft_wrap=True)


@contextmanager
def _lines_with_progress(file: Path) -> Iterator[TextIO]:
    """A text file's lines, with a bar on standard error where that is a terminal."""
    try:
        opened = rich.progress.open(
            file,
            "r",
            encoding="utf-8-sig",
            newline="",
            description="Evaluating",
            console=console,
            disable=not console.is_terminal,
        )
    except OSError as failure:
        raise unreadable(file, failure) from failure
    with opened as lines:
        yield lines
