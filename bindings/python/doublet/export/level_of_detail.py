"""A character's display surface in fewer triangles."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from .. import _doublet as d


def level_of_detail(character: d.Character, triangles: int) -> d.TexturedFaces:
    """About so many triangles in the place of M_high's, of its vertices; all of them where there are no more. Raises ValueError
    if the character has no display surface."""
    if not len(character.high.faces):
        raise ValueError(f"--lod: expected a character with a display surface, found {character.name} without one")
    every = d.drawn_faces(character)
    return every if len(every.faces) <= triangles else d.reduce_faces(character.high.vertices, every, triangles)


def only_drawn(character_file: Path, drawn: d.TexturedFaces) -> d.Character:
    """The character as a renderer needs it to draw these faces. Nothing can animate it: its garment is gone."""
    character = d.Character.read(character_file)
    character.garment_subdivisions, character.high_body = -1, []
    character.high = d.Mesh(character.high.vertices, drawn.faces)
    character.high_valid, character.texcoords = np.ones(len(drawn.faces), bool), drawn.texcoords
    return character
