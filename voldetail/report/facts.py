"""What a report says in words: the light, the search, the inputs."""

from __future__ import annotations

from voldetail.detail import parameter
from voldetail.report.verdict import number
from voldetail.results import EVEN_ENOUGH, AmplitudeInterval, FitResult
from voldetail.setup.light import Light
from voldetail.setup.setup import Setup


def light_words(light: Light) -> str:
    """The light in words, angles in degrees."""
    return light.row.words(light)


def duration(seconds: float) -> str:
    """A time in words: "12 s", "3 min 05 s", "1 h 02 min"."""
    whole = max(0, round(seconds))
    if whole < 60:
        return f"{whole} s"
    if whole < 3600:
        return f"{whole // 60} min {whole % 60:02d} s"
    return f"{whole // 3600} h {whole // 60 % 60:02d} min"


def facts(result: FitResult) -> list[tuple[str, str]]:
    """Label and text of each fact about the photo and the search, in reading order."""
    setup, target = result.setup, result.target
    rows, columns = target.shape
    x, y, width, height = target.zone
    compared = f"{target.mask.shape[1]} x {target.mask.shape[0]}"
    used = 100 * float(target.mask.mean())
    masked = "" if used > 99.95 else f", {used:.0f} % of them used"
    rate = f", {result.evaluations / result.seconds:.1f} a second" if result.seconds > 0 else ""
    notes = f" ({'; '.join(target.photo.notes)})" if target.photo.notes else ""
    return [
        ("Photo", f"{setup.photo.name}, {columns} x {rows} pixels{notes}"),
        ("Zone", f"{width} x {height} pixels at {x}, {y} from the top left; compared at {compared}{masked}"),
        *([("Evenness", evenness_words(result))] if target.unevenness is not None else []),
        ("Light", light_words(setup.light)),
        ("Proxy", _proxy(setup)),
        ("Search", f"{result.evaluations} pictures compared in {duration(result.seconds)}{rate}"),
        ("Solver", f"{setup.fit.solver}, metric {setup.fit.metric}, seed {setup.seed}; {result.status}"),
        ("Distance", distance_words(result)),
        *([("Colour", colour_words(result))] if result.colour is not None else []),
        *([("Medium", medium_words(result))] if result.identifiability else [("Amplitude", amplitude_words(result))]),
    ]


def overlay_words(setup: Setup) -> str:
    """What is drawn over the whole photo."""
    words = "The whole photo: the zone framed in white, what is not used dark"
    flat = setup.proxy.row.flat and setup.camera.kind == "orthographic"
    # A plane that faces the viewer fills the photo and so has no outline in it.
    filled = flat and setup.proxy.size is None and not any(setup.proxy.rotation)
    return words + ("; the proxy is a plane that fills it" if filled else ", the proxy's outline orange")


def distance_words(result: FitResult) -> str:
    """M and the two distances it is held against."""
    floor = result.detail.noise_floor
    text = f"M = {number(result.distance)}"
    if floor.photo_halves is not None:
        text += f"; the photo's halves {number(floor.photo_halves)}"
    if floor.other_seed is not None:
        text += f"; two seeds of the detail {number(floor.other_seed)}"
    return text


def amplitude_words(result: FitResult) -> str:
    """The amplitude and how well the photo tells it."""
    amplitude, heights = result.detail.relief.amplitude, result.heights
    if result.setup.amplitude is not None:
        return f"{number(amplitude)} scene units, as given"
    if heights is None:
        return f"{number(amplitude)} scene units; how well the photo tells it was not looked at"
    text = f"{number(amplitude)} scene units; {_span(heights.low, heights.high, heights)} would be about as near"
    if (heights.low_any, heights.high_any) != (heights.low, heights.high):
        text += f", {_span(heights.low_any, heights.high_any, heights)} if the light were up to 10 degrees lower or higher"
    return text


COLOUR_WORDS = {
    "none": "one tint",
    "noise": "by example",
    "height": "with the relief's height",
    "hollow": "with its hollows",
    "cell": "by the cell",
}


def colour_words(result: FitResult) -> str:
    """How the surface is coloured, and how far from the photo each try was."""
    choice = result.colour
    assert choice is not None
    colour = choice.detail.colour
    text = COLOUR_WORDS["none" if colour is None else colour.driver]
    if choice.distances:
        text += "; distances of colours: " + ", ".join(f"{COLOUR_WORDS[k]} {number(v)}" for k, v in choice.distances.items())
    return text


def evenness_words(result: FitResult) -> str:
    """How uneven the photo is, and whether an even picture was made of it."""
    assert result.target.unevenness is not None
    made = "; an even picture was made of it and fitted" if result.setup.photo.stationarize else ""
    return f"unevenness {number(result.target.unevenness)} (0 is even, up to {EVEN_ENOUGH:g} even enough){made}"


def medium_words(result: FitResult) -> str:
    """What the photo tells of each number of a medium, and what it does not."""
    said, open_ = [], []
    for t in result.identifiability:
        label = parameter(t.key).label.lower()
        if t.unidentified:
            open_.append(label)
            continue
        less, more = (" or less" if t.low <= t.least else ""), (" or more" if t.high >= t.most else "")
        said.append(f"{label} {number(t.value)} ({number(t.low)}{less} to {number(t.high)}{more})")
    words = ", ".join(said) if said else "none of its numbers is told"
    return words + (f"; the photo does not tell {', '.join(open_)}" if open_ and said else "")


def _span(low: float, high: float, heights: AmplitudeInterval) -> str:
    """An interval in words; an end beyond which nothing was looked at says so."""
    least, most = min(heights.amplitudes) * (1 + 1e-9), max(heights.amplitudes) * (1 - 1e-9)
    return f"{number(low)}{' or less' if low <= least else ''} to {number(high)}{' or more' if high >= most else ''}"


def _proxy(setup: Setup) -> str:
    proxy = setup.proxy
    name = f"the mesh {proxy.mesh.name}" if proxy.mesh else f"a {proxy.kind}"
    what = {"displacement": "", "volume": ", filled with a medium" if setup.medium else ", filled with solid matter"}[setup.mode]
    if setup.camera.kind == "orthographic":
        return f"{name}{what}, orthographic camera"
    return f"{name}{what}, perspective camera with {setup.camera.field_of_view:g} degrees across"
