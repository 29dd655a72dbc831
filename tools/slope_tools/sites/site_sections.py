"""The choices of a site as types: a class for each section of site.yaml, whose attributes are its keys.

site_schema.json beside this module has their ranges, defaults and meaning; here are the kinds of their values alone. A
site of another kind says so (`kind`), and the room of that name has a site_schema.json with its own sections and the
names of those that it shares. Choices are frozen: changed() gives others.
"""
import functools
import json
import keyword
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, ClassVar, Dict, Iterator, List, Mapping, Optional, Tuple, Type, TypeVar, Union, get_type_hints

from .. import disk
from ..survey.roads import Asked

SCHEMA = Path(__file__).with_name("site_schema.json")
PACKING = "packing"     # variable of the deck, and of the study: its repeats
C = TypeVar("C", bound="Choices")
Key = Tuple[str, str]       # section and key
Texts = Tuple[str, ...]
Numbers = Tuple[float, ...]


@dataclass(frozen=True)
class Project:
    name: Optional[str]
    client: Optional[str]
    author: Optional[str]


@dataclass(frozen=True)
class Terrain:
    files: Texts
    crs: Optional[str]
    assign_crs: Optional[str]
    z_unit: Optional[str]
    nodata: Union[float, Numbers, None]
    differ: Optional[float]
    bounds: Optional[Numbers]
    cell: Optional[float]
    fill: int


@dataclass(frozen=True)
class Crs:
    assigned: Mapping[str, str]


@dataclass(frozen=True)
class Release:
    polygon: Optional[str]


@dataclass(frozen=True)
class MassRelease(Release):
    shape: Optional[str]
    depth: Optional[float]
    volume: Optional[float]
    curvature: Optional[float]
    dip: Union[float, str, None]
    foundation: Union[float, str, None]    # a level, or a file
    direction: Optional[float]
    scar: Optional[str]
    scar_is: Optional[str]
    least: float
    bodies: Texts


@dataclass(frozen=True)
class Road:
    file: Optional[str]
    width: Optional[float]

    @property
    def asked(self) -> Asked:
        return Asked(self.width)


@dataclass(frozen=True)
class MassRoad(Road):
    others: Texts
    from_: float
    blocked: float
    lane: Optional[float]
    clearing: Optional[float]
    loosening: Optional[float]
    cut_angle: float
    mesh: float

    @property
    def asked(self) -> Asked:
        return Asked(self.width, self.from_, self.blocked, self.lane, self.clearing, self.loosening)


@dataclass(frozen=True)
class Ground:
    file: Optional[str]
    table: Optional[str]


@dataclass(frozen=True)
class Structures:
    files: Texts
    walls: Texts
    height: Optional[float]
    width: Optional[float]
    friction: float
    restitution: float


@dataclass(frozen=True)
class Lines:
    files: Texts


@dataclass(frozen=True)
class Motion:
    file: Optional[str]
    scale: float
    peak_friction: Optional[float]
    peak_rolling: float
    trigger: float


@dataclass(frozen=True)
class Observed:
    file: Optional[str]


@dataclass(frozen=True)
class Known:
    set: Optional[str]
    confined: str


@dataclass(frozen=True)
class Balls:
    diameter: Optional[float]
    number: Optional[int]
    minutes: Optional[float]
    memory: Optional[float]


@dataclass(frozen=True)
class Model:
    spacing: float
    friction: float
    field_restitution: float
    density: float
    speed: Optional[float]
    duration: Optional[float]
    film: Optional[float]
    cell: Optional[float]


@dataclass(frozen=True)
class MassModel(Model):
    slip_friction: float
    restitution: float
    least_speed: Optional[float]
    least_thick: Optional[float]


@dataclass(frozen=True)
class Study:
    rolling: Numbers


@dataclass(frozen=True)
class MassStudy(Study):
    spacing: Numbers
    packing: Tuple[int, ...]
    levels: Optional[int]
    largest_restitution: Optional[float]
    points: int


@dataclass(frozen=True)
class Blocks:
    number: int
    size: Numbers
    grounds: int
    speed: float


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
        for (section, key), value in values.items():
            found[section] = replace(found.get(section, getattr(self, section)), **{attribute(key): frozen(value)})
        return replace(self, **found)


@dataclass(frozen=True, kw_only=True)
class OfMass(Choices):
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
    KIND: ClassVar[str] = "blocks"
    blocks: Blocks


KINDS: Dict[str, Type[Choices]] = {OfMass.KIND: OfMass, OfBlocks.KIND: OfBlocks}


@functools.lru_cache
def schema(kind: str = OfMass.KIND) -> Dict[str, Any]:
    """The JSON schema of site.yaml; of another kind, sections that its file does not describe are those of a mass."""
    about: Dict[str, Any] = json.loads(SCHEMA.read_text(encoding="utf-8"))
    if kind == OfMass.KIND:
        return about
    own = json.loads((SCHEMA.parents[1] / kind / SCHEMA.name).read_text(encoding="utf-8"))
    shared = about["properties"]
    return {**about, **own, "properties": {name: one or shared[name] for name, one in own["properties"].items()}}


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
