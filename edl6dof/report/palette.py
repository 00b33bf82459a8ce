"""The colours of reports and replays, on paper and on a dark ground."""

from __future__ import annotations

#: Colour on a dark background by colour on paper; in both sets the colour-blind can distinguish the colours.
DARK: dict[str, str] = {}


def _inks(*pairs: str) -> tuple[str, ...]:
    """Return colours for paper; each pair also names the colour that replaces it on a dark background."""
    both = [pair.split() for pair in pairs]
    DARK.update({paper: dark for paper, dark in both})
    return tuple(paper for paper, _ in both)


#: Okabe and Ito's palette, distinguishable with every kind of colour vision, without its yellow, which is
#: hard to see on paper.
BLUE, VERMILION, GREEN, PURPLE, ORANGE, SKY, BLACK = SERIES = _inks(
    "#0072B2 #2f8fdc", "#D55E00 #e8702a", "#009E73 #14b88c", "#CC79A7 #d98cc0", "#E69F00 #f2b93b",
    "#56B4E9 #7cc8f7", "#1b1b1b #f0f2f4",
)  # fmt: skip
#: Words, words of less weight, lines of the grid, lines of axes and zero, the ground of a drawing and of a
#: page.
INK, GREY, SOFT, RULE, AXIS, PAPER, GROUND = _inks(
    "#1f2933 #e4e8ec", "#8a8f98 #98a1ac", "#5b6572 #a2abb6", "#e3e6ea #2d343d", "#c3c8cf #4a535e",
    "#ffffff #171b21", "#f5f6f8 #0f1216",
)  # fmt: skip
GOOD, WARN, BAD = _inks("#00795a #35c79a", "#a86700 #e0a63c", "#b3261e #ff7b72")
#: Statuses of numbers (see ``config.base.STATUS_MARKS``).
PUBLISHED, RECALLED, ESTIMATE = _inks("#0072b2 #7cc8f7", "#8c4f7c #d98cc0", "#b34700 #f0955f")
#: Colours of mission phases, in their order; light enough to lie behind lines.
PHASES = _inks(
    "#cfe3f3 #1d3a52", "#f6d9c4 #573220", "#cdeadd #1c4434", "#f1dcea #4b2f41", "#fbe7c0 #544018",
    "#d8effb #1b4557", "#e6e6e6 #3a3f46", "#dcd9f2 #3a345a",
)  # fmt: skip
#: Grounds of classes of cells, light enough for what is drawn on them: from the best to the worst, and
#: unknown ones.
SAFE, UNSEEN, STEEP, ROUGH, UNKNOWN = _inks(
    "#a9d3f2 #2a78c2", "#b4b4b4 #4c525a", "#f9d98c #e0b13c", "#cf7f66 #a83f22", "#e6e8eb #343b44"
)
#: Sequential scale from paper white to dark blue: it saves ink, and lightness alone shows its order.
SEQUENTIAL = _inks(
    "#f7f9fb #1b2027", "#cfe1f2 #173a5e", "#93c4de #1f5f93", "#4a97c9 #3f8fc4", "#1764ab #86bfe3",
    "#08306b #e2f0fa",
)  # fmt: skip
#: Heights of the ground, from low to high.
RELIEF = _inks("#fbf6ef #1f1a16", "#efdfcb #3b2f26", "#dfc4a3 #5f4a3a", "#c9a47d #8a6a50", "#ab825d #b89470")


def rgb(colour: str) -> tuple[int, int, int]:
    """Return the variant of a paper colour for dark backgrounds as red, green and blue, 0 to 255."""
    red, green, blue = bytes.fromhex(DARK[colour][1:])
    return red, green, blue
