"""The light "auto" of a Setup, resolved: guessed from the photo once, before anything else uses it."""

from __future__ import annotations

from voldetail.errors import InputError
from voldetail.fit.lightguess import FLOOR, guess_light
from voldetail.fit.target import mask_of
from voldetail.fit.zone import check_zone
from voldetail.image import Photo, luminance
from voldetail.results import LightGuess
from voldetail.setup.light import FORMS_GIVEN, Light, direction_of
from voldetail.setup.setup import Setup


def resolve_light(setup: Setup, photo: Photo) -> tuple[Setup, LightGuess | None]:
    """Return ``setup`` with the direction that its photo shows in place of "auto", and the LightGuess.

    Another light is left alone, and there is no guess. The same photo, mask and zone always give the same direction.
    Raises InputError where the proxy is no plane facing the camera or the photo is of a medium, and where it does not show
    its light.
    """
    if not setup.light.row.estimated:
        return setup, None
    if not setup.proxy.row.flat or any(setup.proxy.rotation) or setup.medium:
        other = "what is seen is a medium" if setup.medium else "the proxy is another"
        raise InputError(f"The light auto is for a plane that faces the camera, and {other}: give --light as {FORMS_GIVEN}.")
    rows, columns = photo.pixels.shape[:2]
    mask = mask_of(setup, photo)
    # Without a zone the whole photo counts: more bumps tell more.
    zone = setup.photo.zone or (0, 0, columns, rows)
    check_zone(zone, (rows, columns))
    x, y, w, h = zone
    part = (slice(y, y + h), slice(x, x + w))
    guess = guess_light(luminance(photo.pixels)[part], mask[part])
    if guess.confidence < FLOOR:
        raise InputError(
            f"The light of {setup.photo.name} cannot be told from its gradients (confidence {guess.confidence:.2f}, at least"
            f" {FLOOR:g} is needed): give --light as {FORMS_GIVEN}."
        )
    light = Light(direction=direction_of(guess.azimuth, guess.elevation), strength=setup.light.strength)
    return setup.model_copy(update={"light": light}), guess
