"""The choices of a site as types: a class for each section of site.yaml, whose attributes are its keys (site_keys).

A site of another kind says so (`kind`), and has sections of its own. Choices are frozen: changed() gives others.
"""
import functools
import keyword
from dataclasses import dataclass, replace
from typing import Any, ClassVar, Dict, Iterator, List, Mapping, Optional, Tuple, Type, TypeVar, Union, get_type_hints

from .. import disk
from ..survey.roads import Asked
from .site_keys import NEEDED, key, section_schema

VERSION = 1             # of site.yaml
PACKING = "packing"     # variable of the deck, and of the study: its repeats
# in the order in which site.yaml has them
SECTIONS = ("project", "terrain", "release", "crs", "road", "ground", "structures", "lines", "motion", "observed",
            "known", "balls", "blocks", "model", "study")
C = TypeVar("C", bound="Choices")
Key = Tuple[str, str]       # section and key
Texts = Tuple[str, ...]
Numbers = Tuple[float, ...]


@dataclass(frozen=True)
class Project:
    """heading of the report"""
    name: Optional[str] = key(None, "of the site (default: of this folder)")
    client: Optional[str] = key(None)
    author: Optional[str] = key(None)


@dataclass(frozen=True)
class Terrain:
    """as slope terrain takes it"""
    files: Texts = key(NEEDED, "rasters of heights", fewest=1, shortest=1)
    crs: Optional[str] = key(None, "EPSG:n, CRS of the site, and of rasters without one")
    assign_crs: Optional[str] = key(None, "EPSG:n, CRS of the rasters, whatever the files say")
    z_unit: Optional[str] = key(
        None, "of the heights in the rasters, whatever the files say: m, ft, us-ft", of=("m", "ft", "us-ft", None))
    nodata: Union[float, Numbers, None] = key(
        None, "a value of the rasters, or several in brackets, in their own unit, that stands for no height, beside "
        "the one that they declare")
    differ: Optional[float] = key(
        None, "median difference of the heights of two rasters, or step where they meet, that is accepted, m; "
        "null: 5", above=0)
    bounds: Optional[Numbers] = key(None, "W S E N of the part that is used, m", fewest=4, most_items=4)
    cell: Optional[float] = key(None, "m", above=0)
    fill: int = key(0, "fill holes of at most this many cells", least=0)


@dataclass(frozen=True)
class Crs:
    """of single files"""
    assigned: Mapping[str, str] = key({}, "{file: EPSG:n}, whatever the file says")


@dataclass(frozen=True)
class Release:
    """where the blocks start, evenly over the area"""
    polygon: Optional[str] = key(None, "release area")


@dataclass(frozen=True)
class MassRelease(Release):
    """the body, as slope release takes it"""
    shape: Optional[str] = key(None, "of the slip surface", of=("sphere", "ellipsoid", "plane", "slbl", "slab", None))
    depth: Optional[float] = key(None, "largest, vertical, m", above=0)
    volume: Optional[float] = key(None, "m3", above=0)
    curvature: Optional[float] = key(None, "of slbl, 1/m")
    dip: Union[float, str, None] = key(
        None, "of the plane, degrees; least: the sphere that dips least below the foundation", above=0, below=90,
        like="^least$")
    foundation: Union[float, str, None] = key(
        None, "of that sphere: level in m, or a raster; null: the level of the toe")
    direction: Optional[float] = key(None, "to which the plane dips, degrees from north", least=0, most=360)
    scar: Optional[str] = key(None, "raster instead of a shape")
    scar_is: Optional[str] = key(
        None, "what that raster holds; null: a surface, if it follows the terrain",
        of=("surface", "depth", "change", "height", None))
    least: float = key(0, "smaller depths of the scar are ignored, m", least=0)
    bodies: Texts = key((), "surfaces of slope stability, of which the scar is one: values of the deck's variable body")


@dataclass(frozen=True)
class Road:
    """that blocks may reach and pass"""
    file: Optional[str] = key(None, "polygon, or line with a width")
    width: Optional[float] = key(None, "of a line, m", above=0)

    @property
    def asked(self) -> Asked:
        return Asked(self.width)


@dataclass(frozen=True)
class MassRoad(Road):
    """from which the volume is removed"""
    others: Texts = key((), "files of more roads, each with numbers of its own", shortest=1)
    width: Optional[float] = key(None, "of a line, m", above=0)
    from_: float = key(0, "chainage of its start, km")
    blocked: float = key(0.1, "where the deposit is thicker, m", least=0)
    lane: Optional[float] = key(None, "width of a lane that is opened first, m", above=0)
    clearing: Optional[float] = key(None, "m3 of loosened ground that are cleared in an hour", above=0)
    loosening: Optional[float] = key(None, "volume of loosened ground over that of the ground", least=1)
    cut_angle: float = key(30, "rise of the cut from the road's edges, degrees", above=0, below=90)
    mesh: float = key(10, "side of the mesh cells, m", above=0)

    @property
    def asked(self) -> Asked:
        return Asked(self.width, self.from_, self.blocked, self.lane, self.clearing, self.loosening)


@dataclass(frozen=True)
class Ground:
    """zones of the ground with values of their own"""
    file: Optional[str] = key(
        None, "polygons with the attributes name, friction (degrees), rolling, restitution, spacing (diameters), or a "
        "raster of classes")
    table: Optional[str] = key(None, "CSV of the classes of a raster: class and these attributes")


@dataclass(frozen=True)
class Structures:
    """what the mass may hit"""
    files: Texts = key((), "STL", shortest=1)
    walls: Texts = key((), "lines along which a wall stands", shortest=1)
    height: Optional[float] = key(None, "of these walls above the ground, m", above=0)
    width: Optional[float] = key(None, "of these walls, m (default: 1)", above=0)
    friction: float = key(25, "on them, degrees", least=0, below=90)
    restitution: float = key(0.1, "on them", above=0, most=1)


@dataclass(frozen=True)
class Lines:
    """what crosses them is counted"""
    files: Texts = key((), "control lines", shortest=1)


@dataclass(frozen=True)
class Motion:
    """an earthquake that triggers the collapse"""
    file: Optional[str] = key(None, "of slope quake")
    scale: float = key(1, "factor of the motion", above=0)
    peak_friction: Optional[float] = key(None, "peak strength of the body, degrees", least=0, below=90)
    peak_rolling: float = key(1, "its rolling resistance", least=0)
    trigger: float = key(0.1, "strength is lost when the centroid has moved this far, m", above=0)


@dataclass(frozen=True)
class Observed:
    """a mapped deposit with which the runs are compared"""
    file: Optional[str] = key(None, "outline (polygon) or thickness (raster, m)")


@dataclass(frozen=True)
class Known:
    """events that the mass is compared with"""
    set: Optional[str] = key(
        None, "null: rock_avalanches, and where they do not cover the mass translational_slides; else "
        "rock_avalanches, or TYPE[:PATH]: rockfalls (of a rock face), debris_flows:channelized (wet, in a gully), "
        "earthflows_and_mudslides", like="^[A-Za-z_ ]+(:[A-Za-z]+)?$")
    confined: str = key(
        "unknown", "whether valley sides keep the mass from spreading: yes, no, unknown",
        of=("yes", "no", "unknown", True, False))


@dataclass(frozen=True)
class Balls:
    """the coarsest of the study, by the first of diameter, number, memory that is given; else 400 of them"""
    diameter: Optional[float] = key(None, "m", above=0)
    number: Optional[int] = key(None, "of balls in the body", least=1)
    minutes: Optional[float] = key(
        None, "that the study may take on this machine; null: 10, or up to 60 for a bound. They decide how many points "
        "run, and with finer balls",
        above=0)
    memory: Optional[float] = key(None, "GB that its runs may take together, the finest ones, too", above=0)


@dataclass(frozen=True)
class Model:
    """see the page on choosing parameters"""
    spacing: float = key(
        0.9, "of the ground's balls, which are as large as the smallest block, in diameters: its roughness", above=0,
        most=0.95)
    friction: float = key(30, "on the ground, degrees", least=0, below=90)
    field_restitution: float = key(0.1, "on the ground", above=0, most=1)
    density: float = key(2600, "of a block, kg/m3", above=0)
    speed: Optional[float] = key(None, "largest for which the stiffness is sufficient, m/s", above=0)
    duration: Optional[float] = key(None, "time limit of a run, s", above=0)
    film: Optional[float] = key(None, "between two snapshots of a run, s", above=0)
    cell: Optional[float] = key(None, "of the rasters, m", above=0)


@dataclass(frozen=True)
class MassModel(Model):
    """see the page on choosing parameters"""
    spacing: float = key(0.9, "of the ground's balls, in diameters: its roughness", above=0, most=0.95)
    friction: float = key(30, "of soil and ground, degrees", least=0, below=90)
    slip_friction: float = key(0, "of the slip surface, degrees", least=0, below=90)
    restitution: float = key(0.48, "of the soil", above=0, most=1)
    field_restitution: float = key(0.1, "on the ground", above=0, most=1)
    density: float = key(2977, "of a ball, kg/m3; times 0.60: bulk density of the ground", above=0)
    speed: Optional[float] = key(None, "largest for which the stiffness is sufficient, m/s", above=0)
    least_speed: Optional[float] = key(None, "of a scenario, speed is no less than that of its site, m/s", above=0)
    least_thick: Optional[float] = key(None, "the same of the thickness whose weight the stiffness bears, m", above=0)
    duration: Optional[float] = key(None, "time limit of a run, s", above=0)
    film: Optional[float] = key(None, "between two snapshots of a run, s", above=0)
    cell: Optional[float] = key(None, "of the deposit's rasters, m", above=0)


@dataclass(frozen=True)
class Study:
    """the runs of slope study"""
    rolling: Numbers = key(
        (0.1, 0.15, 0.2), "rolling resistances, each a choice: of each number the worst counts",
        fewest=1, different=True, least=0)


@dataclass(frozen=True)
class MassStudy(Study):
    """the runs of slope study"""
    rolling: Numbers = key((0, 0.05, 0.1), "rolling resistances, each a choice", fewest=1, different=True, least=0)
    spacing: Numbers = key(
        (0.5, 0.7), "other grounds, each a choice at both ends of rolling; []: none", different=True, above=0,
        most=0.95)
    packing: Tuple[int, ...] = key(
        (2, 3), "repeats with another packing of the balls than 1, each on scattered balls of its own", different=True,
        least=2, most=1000000)
    levels: Optional[int] = key(
        None, "sizes of balls, each of half the diameter of the one before; null: as time allows; fewer than 3 give a "
        "number without a bound", least=1, most=5)
    largest_restitution: Optional[float] = key(
        0.9, "of soil, slip surface and ground in runs of reach and area alone; null: none", above=0, most=1)
    points: int = key(
        64, "runs that are weighted by known events, beside those above; a power of two; 0: none", least=0)


@dataclass(frozen=True)
class Blocks:
    """they do not see each other"""
    number: int = key(
        3000, "in all runs together, at most 100,000: as many of each rolling resistance, on each ground", least=1)
    size: Numbers = key(
        (1.0,), "diameter, m, or the least and the largest, between which all are as frequent", fewest=1, most_items=2,
        above=0)
    grounds: int = key(
        10, "runs of each rolling resistance, on other scattered balls and with other places of the blocks: what "
        "chance is measured by", least=2, most=1000)
    speed: float = key(0, "at the start, m/s, down the fall line of the plane that fits the release area best", least=0)


@dataclass(frozen=True, kw_only=True)
class Choices:
    """Of a site of any kind, complete."""
    KIND: ClassVar[str] = ""
    project: Project
    terrain: Terrain
    release: Release
    crs: Crs
    road: Road
    ground: Ground
    lines: Lines
    model: Model
    study: Study

    @classmethod
    def of(cls: Type[C], given: Mapping[str, Any]) -> C:
        """Those of what a file holds, or of nothing, with the defaults of all that is not given."""
        hints, values = get_type_hints(cls), {}
        for name, about in sections(cls.KIND):
            own = {**{key: entry.get("default", ()) for key, entry in about["properties"].items()},
                   **(given.get(name) or {})}
            if isinstance(own.get("confined"), bool):       # yes and no without quotes
                own["confined"] = "yes" if own["confined"] else "no"
            values[name] = hints[name](**{attribute(key): frozen(own[key]) for key in about["properties"]})
        return cls(**values)

    def entries(self) -> Dict[str, Any]:
        """The same as a file has them: of() reads it."""
        found: Dict[str, Any] = {"kind": self.KIND} if self.KIND else {}
        for name, about in sections(self.KIND):
            own = {key: self.value(name, key) for key in about["properties"]}
            found[name] = disk.make_plain(own)
        return found

    def has(self, section: str, key: str) -> bool:
        return hasattr(getattr(self, section, None), attribute(key))

    def value(self, section: str, key: str) -> Any:
        """None of a key that a site of this kind does not have."""
        return getattr(getattr(self, section, None), attribute(key), None)

    def files(self, section: str, key: str) -> List[str]:
        """Those of a key that holds one file, several, or none."""
        value = self.value(section, key)
        return [value] if isinstance(value, str) else [] if disk.is_finite_number(value) else list(value or ())

    def changed(self: C, values: Mapping[Key, Any]) -> C:
        """The same with other values of these sections and keys."""
        found: Dict[str, Any] = {}
        for (section, name), value in values.items():
            found[section] = replace(found.get(section, getattr(self, section)), **{attribute(name): frozen(value)})
        return replace(self, **found)


@dataclass(frozen=True, kw_only=True)
class OfMass(Choices):
    """Every choice of a site. Lengths in m, angles in degrees, volumes in m3; paths of files relative to this folder;
    null: none, or determined by slope site"""
    release: MassRelease
    road: MassRoad
    structures: Structures
    motion: Motion
    observed: Observed
    known: Known
    balls: Balls
    model: MassModel
    study: MassStudy

    @property
    def other_grounds(self) -> List[Tuple[float, float]]:
        """(spacing, rolling resistance) of the study's runs on other grounds than the model's."""
        return [(spacing, one) for spacing in self.study.spacing if spacing != self.model.spacing
                for one in sorted({min(self.study.rolling), max(self.study.rolling)})]


@dataclass(frozen=True, kw_only=True)
class OfBlocks(Choices):
    """Every choice of a site of single blocks. Lengths in m, angles in degrees; paths of files relative to this folder;
    null: none, or determined by slope site"""
    KIND: ClassVar[str] = "blocks"
    blocks: Blocks


KINDS: Dict[str, Type[Choices]] = {OfMass.KIND: OfMass, OfBlocks.KIND: OfBlocks}


@functools.lru_cache
def schema(kind: str = OfMass.KIND) -> Dict[str, Any]:
    """The JSON schema of site.yaml."""
    hints = get_type_hints(KINDS[kind])
    properties = {
        "slope_site": {"const": VERSION, "description": "version of this file"},
        **({"kind": {"const": kind, "description": "of site"}} if kind else {}),
        **{name: section_schema(hints[name]) for name in SECTIONS if name in hints},
        "found": {"type": ["object", "null"], "default": None, "description": "what slope site determined; not to be "
                  "changed"}}
    return {"type": "object", "additionalProperties": False, "description": " ".join(str(KINDS[kind].__doc__).split()),
            "required": [name for name in ("slope_site", "kind", "terrain", "release") if name in properties],
            "properties": properties}


def sections(kind: str = OfMass.KIND) -> Iterator[Tuple[str, Dict[str, Any]]]:
    """(name, schema) of the sections that hold choices."""
    for name, about in schema(kind)["properties"].items():
        if "properties" in about:
            yield name, about


def kind_of(given: Any) -> str:
    """Of the site of which a file holds this."""
    kind = given.get("kind") if isinstance(given, dict) else None
    return kind if isinstance(kind, str) and kind in KINDS else OfMass.KIND


def attribute(key: str) -> str:
    """What a key is called here."""
    return f"{key}_" if keyword.iskeyword(key) else key


def frozen(value: Any) -> Any:
    return tuple(value) if isinstance(value, list) else value


def widest() -> float:
    """The largest spacing of the ground's balls, in diameters: through a wider one balls fall."""
    most: float = schema()["properties"]["model"]["properties"]["spacing"]["maximum"]
    return most
