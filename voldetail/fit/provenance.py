"""What a finished detail carries with it: its noise floor, and where it came from."""

from __future__ import annotations

import importlib.metadata
from dataclasses import asdict, dataclass
from datetime import UTC, datetime

from pydantic import JsonValue

from voldetail import __version__
from voldetail.detail import Detail, NoiseFloor, Provenance, rounded
from voldetail.errors import InputError
from voldetail.files import sha256
from voldetail.fit.objective import Evaluation
from voldetail.fit.session import Session, derived_seed
from voldetail.metric import describe, distance
from voldetail.results import AmplitudeInterval, ColourChoice, Identifiability, LightGuess, Target
from voldetail.setup.light import light_text
from voldetail.setup.setup import Setup


@dataclass(frozen=True)
class Findings:
    """What a fit ends with besides the detail, for its provenance; see FitResult."""

    status: str
    light_guess: LightGuess | None
    heights: AmplitudeInterval | None
    identifiability: tuple[Identifiability, ...]
    background: tuple[float, float, float]
    colour: ColourChoice | None = None


def signed(final: Evaluation, setup: Setup, target: Target, session: Session, findings: Findings) -> Detail:
    """Return the detail with its noise floor and provenance."""
    other = session.fine.evaluate(final.detail, derived_seed(session.root_seed, "floor"))
    floor = _floor(final, other, setup.fit.metric)
    version = importlib.metadata.version
    provenance = Provenance(
        voldetail=__version__,
        created=datetime.now(UTC).isoformat(timespec="seconds"),
        photo=setup.photo.name,
        photo_sha256=target.photo.sha256,
        mask_sha256=sha256(setup.mask) if setup.mask else None,
        zone=target.zone,
        resolution=setup.photo.resolution,
        light=light_text(setup.light),
        proxy=setup.proxy.kind,
        solver=setup.fit.solver,
        metric=setup.fit.metric,
        evaluations=session.evaluations,
        seconds=round(session.seconds, 2),
        distance=final.distance,
        mitsuba=version("mitsuba"),
        drjit=version("drjit"),
        numpy=version("numpy"),
        settings=_settings(final, setup, target, session, findings),
    )
    named = final.detail.model_copy(
        update={
            "name": (setup.photo.skimage or setup.photo.name)[:200],
            "noise_floor": NoiseFloor(other_seed=floor, photo_halves=target.photo_halves),
            "provenance": provenance,
        }
    )
    return rounded(Detail.model_validate(named.model_dump()))


def _settings(final: Evaluation, setup: Setup, target: Target, session: Session, findings: Findings) -> dict[str, JsonValue]:
    """What else the detail is to say of its fit, by name; only what there was."""
    settings: dict[str, JsonValue] = {"root_seed": setup.seed, "status": findings.status, "noise_seeds": setup.fit.seeds}
    if findings.light_guess is not None:
        settings["light_estimated"] = dict(asdict(findings.light_guess))
    if findings.heights is not None:
        settings["amplitude_interval"] = {key: float(f"{value:.3g}") for key, value in findings.heights.ends.items()}
    if findings.identifiability:
        settings["medium_intervals"] = {t.key: [float(f"{v:.3g}") for v in (t.low, t.high)] for t in findings.identifiability}
    if target.unevenness is not None:
        settings["unevenness"] = float(f"{target.unevenness:.3g}")
    if session.started:
        settings["library"] = setup.fit.library
    if setup.photo.stationarize:
        settings["stationarized"] = True
    if findings.colour is not None:
        far: dict[str, JsonValue] = {driver: float(f"{value:.4g}") for driver, value in findings.colour.distances.items()}
        settings["colour"] = {"chosen": findings.colour.chosen, "distances": far}
    if final.detail.medium is not None:
        settings["background"] = [float(f"{value:.4g}") for value in findings.background]
    return settings


def _floor(one: Evaluation, other: Evaluation, metric: str) -> float | None:
    """Return the distance between two seeds of one detail, or None where they share too little to be compared."""
    mask = one.mask & other.mask
    try:
        own = describe(one.picture, mask, metric=metric)
        return distance(own, describe(other.picture, mask, like=own))
    except InputError:
        return None
