"""Structure models of GKHF14 section 6: two-tone procedural textures without their colours."""

from voldetail.texture.structures.colour import checked_structure, structure_colour
from voldetail.texture.structures.model import StructureModel, StructureParameter
from voldetail.texture.structures.models import MODELS
from voldetail.texture.structures.picture import structure

__all__ = ["MODELS", "StructureModel", "StructureParameter", "checked_structure", "structure", "structure_colour"]
