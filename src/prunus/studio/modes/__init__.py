"""What a click and the keys mean: one file a mode."""

from prunus.studio.modes.clean import Clean
from prunus.studio.modes.correct import Correct
from prunus.studio.modes.cuts import Cuts
from prunus.studio.modes.label import Label
from prunus.studio.modes.look import Look

MODES = (Look, Correct, Clean, Label, Cuts)
"""In the order of the page."""
