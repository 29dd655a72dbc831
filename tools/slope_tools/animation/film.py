"""The film of a report: plan and section of the moving balls, drawn frame by frame and made an MP4 by ffmpeg."""
import shutil
import subprocess
import tempfile
from pathlib import Path
from typing import NamedTuple, Optional, Tuple

import numpy as np
from matplotlib.cm import ScalarMappable
from matplotlib.colors import LinearSegmentedColormap, Normalize
from matplotlib.lines import Line2D

from ..digits import rounded
from ..drawing import figures, pictures
from ..drawing.figures import FULL, STYLE
from ..plots import figure_maps
from .frames import Frames
from .scene import MOVES, fastest, tones

RATE = 10               # pictures per second
LONGEST = 12.0          # s
PACES = (0.25, 0.5, 1, 2, 5, 10, 20, 50, 100, 200, 500, 1000)      # s of the run per second of film
MOST_BALLS = 12_000       # that are drawn
DPI = 120               # a film of 7 inches is 840 pixels wide
AT_REST = "#a3937b"
TALLEST = 4.6           # inches of the plan
HOLD = 1.0              # s that the last picture stays


class Film(NamedTuple):
    """An MP4, and a sentence on it; no content: why there is none."""
    content: Optional[bytes]
    text: str
    failed: bool = False        # it may be made another time


def film(data, ground, section, layers, frames: Optional[Frames], name: str) -> Film:
    """The Film of a run; name: of its file, for the sentence."""
    if frames is None:
        return Film(None, "")
    program = shutil.which("ffmpeg")
    if program is None:
        return Film(None, "No film: it needs ffmpeg (Debian package ffmpeg).")
    frames, note = fewer(frames)
    length = float(frames.time[-1] - frames.time[0])
    pace = next((one for one in PACES if length / one <= LONGEST), PACES[-1])
    times = np.append(np.arange(frames.time[0], frames.time[-1], pace / RATE),
                      np.full(round(HOLD * RATE), frames.time[-1]))
    picture = Picture(data, ground, section, layers, frames)
    try:
        with pictures.settings(STYLE):
            content = encode(program, picture, times)
    except (OSError, subprocess.SubprocessError) as error:
        return Film(None, f"No film: ffmpeg could not make it ({' '.join(str(error).split())[:200]}).", True)
    return Film(content, f"The same as a film, in plan and along the section, {len(times) / RATE:.0f} s "
                         f"long{'' if pace == 1 else f', {speed(pace)} real time'}{note}: {name}, beside this page.")


def speed(pace: float) -> str:
    """How fast a film is, against real time."""
    return f"{pace:g} times as fast as" if pace > 1 else f"{1 / pace:g} times slower than"


def fewer(frames: Frames) -> Tuple[Frames, str]:
    """At most MOST_BALLS balls, larger ones for those that are left out, and a note on it."""
    balls = frames.place.shape[1]
    if balls > MOST_BALLS:
        kept = np.sort(np.random.default_rng(0).choice(balls, MOST_BALLS, replace=False))
        factor = balls / MOST_BALLS
        frames = frames._replace(place=frames.place[:, kept], speed=frames.speed[:, kept],
                                 diameter=frames.diameter[kept] * factor ** (1 / 3), factor=frames.factor * factor)
    return frames, "" if frames.factor == 1 else f", {frames.place.shape[1]:,} of the {frames.balls:,} balls"


def encode(program: str, picture: "Picture", times: np.ndarray) -> bytes:
    """The MP4 of a picture at times."""
    wide, tall = picture.size
    with tempfile.TemporaryDirectory() as folder, tempfile.TemporaryFile() as errors:
        path = Path(folder) / "film.mp4"
        command = [program, "-nostdin", "-loglevel", "error", "-f", "rawvideo", "-pix_fmt", "rgba", "-s",
                   f"{wide}x{tall}", "-r", str(RATE), "-i", "-", "-c:v", "libx264", "-preset", "veryfast", "-crf", "24",
                   "-pix_fmt", "yuv420p", "-vf", "crop=trunc(iw/2)*2:trunc(ih/2)*2", "-movflags", "+faststart",
                   "-threads", "1", "-y", str(path)]
        with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.DEVNULL, stderr=errors) as process:
            assert process.stdin is not None
            try:
                for time in times:
                    process.stdin.write(picture.at(time))
                process.stdin.close()
            except BrokenPipeError:     # it says why
                pass
            except BaseException:
                process.kill()
                raise
        if process.returncode != 0 or not path.is_file():
            errors.seek(0)
            raise OSError(errors.read().decode("utf-8", "replace") or f"status {process.returncode}")
        return path.read_bytes()


class Picture:
    """Plan above, section below; between frames only the balls and the time are redrawn."""

    def __init__(self, data, ground, section, layers, frames):
        self.frames, self.section = frames, section
        self.top = fastest(frames.speed)
        colours = LinearSegmentedColormap.from_list("speed", tones("speed"))
        colours.set_under(AT_REST)
        norm = Normalize(MOVES, self.top)
        with pictures.settings({**STYLE, "figure.constrained_layout.use": False}):
            self.figure, axes = self.sheet(layers)
            self.plan(axes[0], layers._replace(ground=ground.base, section=section.points))
            self.profile(axes[1])
            self.colours = ScalarMappable(norm, colours)
            bar = self.figure.colorbar(self.colours, cax=axes[2], orientation="horizontal", extend="min")
            bar.set_label(f"speed of the balls (m/s); grey-brown: slower than {MOVES:g} m/s", labelpad=1)
            name = f"{data.label(data.result)}: " if data.study else ""
            self.figure.text(0.02, 0.985, f"{name}balls in plan and within {rounded(self.band, 2)} m of the section",
                             va="top", fontweight="bold", fontsize=STYLE["axes.titlesize"])
            self.clock = self.figure.text(0.98, 0.985, "", va="top", ha="right", fontweight="bold", fontsize=11)
            self.clock.set_animated(True)
            self.figure.canvas.draw()
        self.still = self.figure.canvas.copy_from_bbox(self.figure.bbox)
        self.size: Tuple[int, int] = self.figure.canvas.get_width_height()
        self.panels = [Panel(axis, self.size[1]) for axis in axes[:2]]

    def sheet(self, layers):
        """Figure, and axes of plan, section and scale; inches, from the top."""
        section, shown = self.section, layers.shown
        self.heights = np.nanmin(section.base), np.nanmax(section.before)
        room = 0.06 * np.ptp(self.heights) + 2 * self.frames.diameter.max()
        self.heights = self.heights[0] - room, self.heights[1] + room
        inner = FULL - 0.75
        plan = [inner, inner * (shown[3] - shown[1]) / (shown[2] - shown[0])]
        if plan[1] > TALLEST:
            plan = [plan[0] * TALLEST / plan[1], TALLEST]
        profile = [inner, inner * np.ptp(self.heights) / np.ptp(section.s)]
        if profile[1] > TALLEST / 1.5:
            profile = [profile[0] * TALLEST / 1.5 / profile[1], TALLEST / 1.5]
        tall = 0.35 + plan[1] + 0.5 + profile[1] + 0.95
        figure = pictures.figure(figsize=(FULL, tall), dpi=DPI)
        tops = 0.35, 0.35 + plan[1] + 0.5
        axes = [figure.add_axes([(0.55 + (inner - size[0]) / 2) / FULL, 1 - (top + size[1]) / tall, size[0] / FULL,
                                 size[1] / tall]) for top, size in zip(tops, (plan, profile))]
        axes.append(figure.add_axes([0.55 / FULL, 0.36 / tall, 2.4 / FULL, 0.1 / tall]))
        return figure, axes

    def plan(self, axis, layers):
        """Relief, road, release and section from above."""
        shown = layers.shown
        figure_maps.base_map(axis, layers)
        figure_maps.draw_section_line(axis, layers, axis.get_window_extent().size / DPI)
        axis.set(xlim=(shown[0], shown[2]), ylim=(shown[1], shown[3]), xlabel="x (m)", ylabel="y (m)")
        axis.tick_params(labelsize=6)
        if layers.raster.crs is not None:
            axis.annotate("N", (0.975, 0.955), (0.975, 0.84), "axes fraction", ha="center", va="center", fontsize=8,
                          fontweight="bold", arrowprops={"arrowstyle": "-|>", "color": "black", "lw": 1})

    def profile(self, axis):
        """The ground before and without the body along the section."""
        section = self.section
        self.band = float(max(1.5 * np.median(self.frames.diameter), 0.01 * section.line.length))
        axis.fill_between(section.s, self.heights[0], section.base, color="#dcd7cf", lw=0, zorder=1)
        axis.plot(section.s, section.base, color="#6b6459", lw=0.7, zorder=3)
        axis.plot(section.s, section.before, color="#333333", lw=0.7, ls="--", zorder=3)
        if section.data.road is not None:
            for start, end in section.road()[0]:
                axis.axvspan(start, end, color=figures.ROAD, alpha=0.15, lw=0)
        axis.set(xlim=(section.s[0], section.s[-1]), ylim=self.heights, ylabel="height (m)",
                 xlabel="distance from A (m); heights not exaggerated")
        axis.tick_params(labelsize=6)
        handles = [Line2D([], [], color="#333333", lw=0.7, ls="--"), Line2D([], [], color="#6b6459", lw=0.7)]
        self.figure.legend(handles, ["ground before", "without the body"], fontsize=6, loc="lower right", ncols=2,
                           frameon=False)

    def at(self, time: float):
        """The picture at a time, as RGBA bytes."""
        place, speed = between(self.frames, time)
        order = np.argsort(place[:, 2])
        order = order[np.isfinite(place[order, 2])]
        place, size = place[order], self.frames.diameter[order]
        colours = self.colours.to_rgba(speed[order], bytes=True)[:, :3]
        self.clock.set_text(f"t = {time:.1f} s")
        canvas = self.figure.canvas
        canvas.restore_region(self.still)
        self.figure.draw_artist(self.clock)
        pixels = np.array(canvas.buffer_rgba())
        self.panels[0].balls(pixels, place[:, :2], size, colours)
        s, off = on_line(self.section.points, place[:, :2])
        near = off <= self.band
        self.panels[1].balls(pixels, np.column_stack([s, place[:, 2]])[near], size[near], colours[near])
        return pixels.tobytes()


class Panel:
    """Axes of a picture that is so many pixels high, and spheres on them: matplotlib takes ten times as long."""

    def __init__(self, axis, tall: int):
        self.matrix = axis.transData.get_matrix()
        box = axis.get_window_extent()
        self.tall, self.inside = tall, (box.x0 + 1, box.x1 - 1, tall - box.y1 + 1, tall - box.y0 - 1)

    def balls(self, pixels, points, size, colours) -> None:
        """Draw lit spheres at points of the axes into an array of pixels, rows from the top; later ones cover."""
        radii = np.maximum(1.0, np.round(size * self.matrix[0, 0]) / 2)
        column = np.round(points[:, 0] * self.matrix[0, 0] + self.matrix[0, 2]).astype(int)
        row = np.round(self.tall - points[:, 1] * self.matrix[1, 1] - self.matrix[1, 2]).astype(int)
        for radius in np.unique(radii):
            mine = radii == radius
            reach = int(radius)
            right, down = (side.ravel() for side in np.meshgrid(*[np.arange(-reach, reach + 1)] * 2))
            out = np.hypot(right, down) / (radius + 0.25)
            right, down, out = right[out <= 1], down[out <= 1], out[out <= 1]
            up = np.sqrt(1 - out ** 2)
            light = np.clip((-0.5 * right - 0.5 * down) / radius + 0.71 * up, 0, 1)      # from the upper left
            shade = (0.45 + 0.6 * light) * (0.65 + 0.35 * up)
            x, y = column[mine, None] + right, row[mine, None] + down
            seen = (x >= self.inside[0]) & (x <= self.inside[1]) & (y >= self.inside[2]) & (y <= self.inside[3])
            lit = np.minimum(colours[mine, None, :] * shade[:, None], 255).astype(np.uint8)
            pixels[y[seen], x[seen], :3] = lit[seen]


def between(frames: Frames, time: float):
    """Places and speeds at a time, on straight lines between the snapshots; NaN where a ball is in one only."""
    k = int(np.clip(np.searchsorted(frames.time, time, "right") - 1, 0, len(frames.time) - 2))
    share = (time - frames.time[k]) / (frames.time[k + 1] - frames.time[k])
    return tuple(values[k] + share * (values[k + 1] - values[k]) for values in (frames.place, frames.speed))


def on_line(line, points) -> Tuple[np.ndarray, np.ndarray]:
    """Distance of points along a line of several segments, and from it (m)."""
    along, off = np.zeros(len(points)), np.full(len(points), np.inf)
    passed = 0.0
    for start, end in zip(line[:-1], line[1:]):
        way = end - start
        length = float(np.hypot(*way))
        share = np.clip((points - start) @ way / length ** 2, 0, 1)
        far = np.hypot(*(points - start - share[:, None] * way).T)
        along, off = np.where(far < off, passed + share * length, along), np.minimum(off, far)
        passed += length
    return along, off
