"""How pictures look: styles, maps on a shaded relief."""
import warnings

# a letter that no font of matplotlib has is a box in the picture; its warnings, several lines each, help nobody
warnings.filterwarnings("ignore", "Glyph .* missing from", UserWarning)
warnings.filterwarnings("ignore", "No contour levels were found", UserWarning)      # a mask without a rim
