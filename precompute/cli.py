"""The command `diffraction`."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console
from rich.progress import track

from precompute.errors import InputError

app = typer.Typer(no_args_is_help=True, add_completion=False, pretty_exceptions_enable=False)
console = Console(stderr=True)


@app.callback()
def main() -> None:
    """Precompute, check and report diffraction for three-diffraction."""


@contextmanager
def one_line_errors() -> Iterator[None]:
    """Bad input ends the command with its one line and exit code 2."""
    try:
        yield
    except InputError as error:
        console.print(str(error), style="red", markup=False, soft_wrap=True)
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
        total = 0
        for recipe in track(recipes, description="Baking", console=console):
            files = bake_recipe(recipe, output)
            total += sum(file.stat().st_size for file in files)
        console.print(f"{len(recipes)} maps, {total / 1024:.0f} KiB, in {output}")
