"""A saved twin opens where its meshes lie elsewhere: each is known by its content, and by nothing else."""

import shutil
from pathlib import Path

import pyoxigraph as ox
import pytest

from sdt_kg.errors import GraphError, UrdfError
from sdt_kg.history import History, obstacle, reopened
from sdt_kg.iri import SDT, model_iri
from sdt_kg.load import load_twin
from sdt_kg.mechanism import Geometry, Pose, ShapeType
from sdt_kg.store import MemoryStore
from sdt_kg.twin import Twin
from tests.sdt_kg.conftest import link

FILE = ox.NamedNode(SDT + "meshFile")
MESHES = ("near/m.stl", "far/m.stl")
ALIKE = pytest.mark.parametrize("portable", [False, True], ids=["as it is", "portable"])


@pytest.fixture(autouse=True)
def _no_folder_of_models(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("SDT_MODELS", raising=False)


@pytest.fixture
def maker(tmp_path: Path) -> Path:
    """The folder of who made a kitchen with two meshes of one name."""
    folder = tmp_path / "home" / "maker" / "kitchen"
    for name in MESHES:
        (folder / name).parent.mkdir(parents=True)
        (folder / name).write_bytes(f"solid {name}".encode())
    shapes = "".join(link(name.partition("/")[0], f'<mesh filename="{name}"/>') for name in MESHES)
    joint = '<joint name="j" type="fixed"><parent link="near"/><child link="far"/></joint>'
    (folder / "k.urdf").write_text(f'<robot name="k">{shapes}{joint}</robot>', encoding="utf-8")
    return folder


def saved(folder: Path, portable: bool) -> ox.Store:
    twin, store = load_twin(folder / "k.urdf"), ox.Store()
    store.load((twin.portable if portable else twin.serialize)("nquads"), format=ox.RdfFormat.N_QUADS)
    return store


def files(twin: Twin) -> list[str]:
    return [one.mesh_file for body in twin.mechanism(model_iri("k")).bodies for one in body.collision]


@ALIKE
def test_it_opens_with_its_files_beside_it(maker: Path, tmp_path: Path, portable: bool) -> None:
    twin, store = load_twin(maker / "k.urdf"), saved(maker, portable)
    here = shutil.move(maker, tmp_path / "here" / "kitchen")
    back = Twin.from_quads(store, beside=here)
    assert files(back) == [str(here / name) for name in MESHES]
    assert back.content_hash(back.environment) == twin.content_hash(twin.environment)
    path = here / "k.trig"
    path.write_bytes(store.dump(format=ox.RdfFormat.TRIG))
    assert files(load_twin(path)) == files(back)


def test_a_history_of_it_opens_with_its_files_beside_it(maker: Path, tmp_path: Path) -> None:
    twin, store = load_twin(maker / "k.urdf"), MemoryStore()
    history = History.of(twin, store)
    cube = (Geometry(ShapeType.BOX, Pose(), (0.2, 0.2, 0.2)),)
    _, made = history.derived(history.first, obstacle(twin, "crate", cube, Pose((1.0, 0.0, 0.1))))
    here = shutil.move(maker, tmp_path / "here" / "kitchen")
    with pytest.raises(GraphError, match="is not there"):
        reopened(store.everything())
    again = reopened(store.everything(), beside=here)
    assert again.branches[made.iri].content_hash == made.content_hash
    assert files(again.first.twin) == [str(here / name) for name in MESHES]


@ALIKE
def test_it_opens_with_its_files_in_the_folder_of_models(
    maker: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, portable: bool
) -> None:
    store = saved(maker, portable)
    models = shutil.move(maker.parent, tmp_path / "models")
    with pytest.raises(GraphError, match=r"is not there.*or set SDT_MODELS to the folder that holds it"):
        Twin.from_quads(store)
    monkeypatch.setenv("SDT_MODELS", str(models))
    assert files(Twin.from_quads(store)) == [str(models / "kitchen" / name) for name in MESHES]


@ALIKE
def test_another_file_of_its_name_does_not_pass_for_it(maker: Path, tmp_path: Path, portable: bool) -> None:
    store = saved(maker, portable)
    here = shutil.move(maker, tmp_path / "here")
    (here / "far" / "m.stl").write_bytes(b"solid other")
    (here / "m.stl").write_bytes(b"solid another")
    with pytest.raises(GraphError, match=r"'far' of 'k' is another file .*\(found: 'far/m.stl'\)"):
        Twin.from_quads(store, beside=here)


def test_another_file_in_the_folder_of_models_is_told(
    maker: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    store = saved(maker, portable=True)
    here = shutil.move(maker, tmp_path / "here")
    (here / "far" / "m.stl").write_bytes(b"solid other")
    monkeypatch.setenv("SDT_MODELS", str(here))
    with pytest.raises(GraphError, match=r"'far' of 'k' is another file .*\(found: 'far/m.stl'\)"):
        Twin.from_quads(store)


def test_where_a_file_is_still_where_it_was_no_other_folder_counts(maker: Path, tmp_path: Path) -> None:
    store = saved(maker, portable=False)
    here = shutil.copytree(maker, tmp_path / "here")
    assert files(Twin.from_quads(store, beside=here)) == [str(maker / name) for name in MESHES]


@pytest.mark.parametrize(
    ("packages", "addresses"),
    [
        ((), ["package://kitchen/far/m.stl", "package://kitchen/near/m.stl"]),
        ((".",), ["package://kitchen/far/m.stl", "package://kitchen/near/m.stl"]),
        (("far",), ["package://far/m.stl", "package://near/m.stl"]),
    ],
)
def test_a_portable_twin_tells_no_folder_of_its_maker(maker, packages, addresses) -> None:
    for each in packages:
        (maker / each / "package.xml").write_text("<package/>", encoding="utf-8")
    store = saved(maker, portable=True)
    assert sorted(quad.object.value for quad in store.quads_for_pattern(None, FILE, None)) == addresses
    assert "maker" not in store.dump(format=ox.RdfFormat.N_QUADS).decode()


def test_an_address_begins_at_the_folder_of_the_model(maker: Path) -> None:
    for name in ("k.urdf", *MESHES):
        (maker / "sub" / name).parent.mkdir(parents=True, exist_ok=True)
        (maker / name).rename(maker / "sub" / name)
    twin, store = load_twin(maker / "sub" / "k.urdf"), ox.Store()
    store.load(twin.portable("nquads", maker), format=ox.RdfFormat.N_QUADS)
    addresses = sorted(quad.object.value for quad in store.quads_for_pattern(None, FILE, None))
    assert addresses == ["package://kitchen/sub/far/m.stl", "package://kitchen/sub/near/m.stl"]


def test_letters_that_no_address_has_come_back(maker: Path, tmp_path: Path) -> None:
    odd = maker.rename(maker.parent / "my kitchen é@#")
    store = saved(odd, portable=True)
    here = shutil.move(odd, tmp_path / "here" / odd.name)
    assert files(Twin.from_quads(store, beside=here.parent)) == [str(here / name) for name in MESHES]


@pytest.mark.parametrize("address", ["package://k/../../secret", "file:///no%00where", "file:///../secret"])
def test_an_address_leads_out_of_no_folder(maker: Path, tmp_path: Path, address: str) -> None:
    store = saved(maker, portable=False)
    quad = next(quad for quad in store.quads_for_pattern(None, FILE, None) if "near" in quad.object.value)
    (tmp_path / "secret").write_bytes((maker / MESHES[0]).read_bytes())
    store.remove(quad)
    store.add(ox.Quad(quad.subject, quad.predicate, ox.NamedNode(address), quad.graph_name))
    (tmp_path / "a" / "b").mkdir(parents=True)
    with pytest.raises(GraphError, match="of body 'near' of 'k' is not there"):
        Twin.from_quads(store, beside=tmp_path / "a" / "b")


def test_a_format_with_more_files_is_refused_wherever_it_lies(maker: Path, tmp_path: Path) -> None:
    store = saved(maker, portable=False)
    quad = next(quad for quad in store.quads_for_pattern(None, FILE, None) if "near" in quad.object.value)
    (tmp_path / "m.glb").write_bytes((maker / MESHES[0]).read_bytes())
    store.remove(quad)
    store.add(ox.Quad(quad.subject, FILE, ox.NamedNode((tmp_path / "m.glb").as_uri()), quad.graph_name))
    with pytest.raises(UrdfError, match="may lie in other files too"):
        Twin.from_quads(store)
