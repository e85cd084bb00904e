"""`doublet edit-character`: a character in another material and other colours."""

from __future__ import annotations

from pathlib import Path

from ... import _doublet as d
from ...export.character_edit import colour_of, set_body_colour, set_texture, set_underwear, write_texture
from ...reconstruct.options import with_pairs

EDITS = ("material", "material_file", "texture", "body_colour", "underwear", "name")


def register(commands) -> None:
    text = "changes the material, texture or skin colour of a character"
    command = commands.add_parser("edit-character", help=text, description=text)
    command.add_argument("character", type=Path, metavar="CHARACTER.glb")
    command.add_argument("-o", "--out", type=Path, metavar="OUT.glb", help="the new character")
    flag = command.add_argument
    flag("--material", nargs="+", default=[], metavar="NAME=X", help="of all cloth, or of --region: k_bend=0.4 d_n=3")
    flag("--material-file", type=Path, metavar="FILE", help="a material.json of a fit or of the page of `doublet view`")
    flag("--region", type=int, metavar="N", help="the cloth region that --material is for, from 0 (default: all)")
    flag("--texture", type=Path, metavar="FILE", help="another texture, PNG or JPEG, in the layout of the character's own")
    flag("--write-texture", type=Path, metavar="FILE", help="write the character's own texture, to paint on")
    flag("--body-colour", metavar="COLOUR", help="colour of the skin under the garment: '#c08060', 'sienna'")
    flag("--underwear", metavar="COLOUR", help="colour of plain underwear on the hidden body, down to the middle of the thighs")
    flag("--name", help="name of the character in the file")
    flag("--debug", action="store_true", help="show the traceback of an error")
    command.set_defaults(run=run, usage_error=command.error)


def run(arguments) -> None:
    edits = any(getattr(arguments, name) for name in EDITS)
    if not arguments.out and (edits or not arguments.write_texture):
        arguments.usage_error("the following arguments are required: -o/--out")
    character = d.Character.read(arguments.character)
    if arguments.write_texture:
        print(write_texture(character, arguments.write_texture))
    if not arguments.out:
        return
    if arguments.out.suffix != ".glb":
        raise ValueError(f"{arguments.out} must end in .glb")
    change(character, arguments)
    character.write(arguments.out)
    print(arguments.out)


def change(character: d.Character, arguments) -> None:
    """Colours come after the texture that they are painted into."""
    if arguments.region is not None and not arguments.material:
        raise ValueError("--region: expected --material beside it, found none")
    if arguments.material_file:
        character.materials = materials_in(arguments.material_file, character)
    if arguments.material:
        character.materials = materials_of(character, arguments.material, arguments.region)
    if arguments.texture:
        set_texture(character, arguments.texture)
    if arguments.body_colour:
        set_body_colour(character, colour_of(arguments.body_colour, "--body-colour"))
    if arguments.underwear:
        set_underwear(character, colour_of(arguments.underwear, "--underwear"))
    if arguments.name:
        character.name = arguments.name


def materials_of(character: d.Character, pairs: list[str], region: int | None = None) -> list[d.Material]:
    count = len(character.materials)
    if not count:
        raise ValueError(f"--material: expected a character with cloth, found none in {character.name}")
    if region is not None and not 0 <= region < count:
        raise ValueError(f"--region: expected one of the character's {count} cloth regions, from 0, found {region}")
    return [
        with_pairs(material, pairs, "--material") if region in (None, k) else material
        for k, material in enumerate(character.materials)
    ]


def materials_in(path: Path, character: d.Character) -> list[d.Material]:
    """Of the character's solver, where the file names one: in another the same numbers are another cloth."""
    found, count = d.read_materials(path, character.solver), len(character.materials)
    if len(found) != count:
        raise RuntimeError(f"{path}: expected materials of the character's {count} cloth regions, found {len(found)}")
    return found
