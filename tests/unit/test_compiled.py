import importlib.util
import shutil

import numba
import pytest
from numba.core.caching import IndexDataCacheFile

from fprc import compiled, control_laws, rig


@pytest.fixture(autouse=True)
def default_cache(monkeypatch):
    """Kernels are cached beside their sources, whatever NUMBA_CACHE_DIR says."""
    monkeypatch.setattr(numba.config, "CACHE_DIR", "")


@pytest.fixture
def package(tmp_path):
    """Copy of the rig package's sources, which its cached files are named after."""
    copy = tmp_path / "rig"
    shutil.copytree(rig.__path__[0], copy, ignore=shutil.ignore_patterns("__pycache__"))
    return copy


@pytest.fixture
def kernel_of(package):
    """Compile a function of one of the package's modules."""
    alive = []  # no module of this name can be imported: numba finds it while a kernel lives

    def build():
        path = package / "of_one_line.py"
        if not path.exists():
            path.write_text("def f(x):\n    return 2.0 * x\n", encoding="utf-8")
        spec = importlib.util.spec_from_file_location(path.stem, path)
        module = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(module)
        alive.append(compiled.kernel(module.f))
        return alive[-1]

    return build


def hits(function):
    """Return how many kernels came from the cache."""
    function(1.0)
    return sum(function.stats.cache_hits.values())


@pytest.mark.parametrize("source", ["friction", "control_laws", "compiled"])
def test_cache_goes_with_any_source_of_the_package_the_laws_or_how_it_is_compiled(
    package, kernel_of, tmp_path, monkeypatch, source
):
    monkeypatch.setattr(numba.config, "CACHE_DIR", str(tmp_path / "chosen"))
    for ours in (compiled, control_laws):
        shutil.copy(ours.__file__, tmp_path)
    monkeypatch.setattr(compiled, "__file__", str(tmp_path / "compiled.py"))
    assert [hits(kernel_of()), hits(kernel_of())] == [0, 1]
    folder = package if source == "friction" else tmp_path
    with open(folder / f"{source}.py", "a", encoding="utf-8") as file:
        file.write("# changed\n")
    with monkeypatch.context() as full_disk:
        full_disk.setattr(IndexDataCacheFile, "_save_data", lambda *_: 1 / 0)
        with pytest.raises(ZeroDivisionError):
            kernel_of()(1.0)
    assert [hits(kernel_of()), hits(kernel_of())] == [0, 1]


@pytest.mark.parametrize("kind", ["*.nbi", "*.nbc"])
@pytest.mark.parametrize("left", [0, 100])
def test_damaged_cache_is_compiled_again(package, kernel_of, kind, left):
    kernel_of()(1.0)
    (file,) = package.rglob(kind)
    file.write_bytes(file.read_bytes()[:left])
    assert kernel_of()(3.0) == 6.0
    assert hits(kernel_of()) == 1


def test_package_that_cannot_be_written_is_cached_in_the_users_folder_or_not_at_all(
    package, kernel_of, tmp_path, monkeypatch
):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "users"))
    (package / "__pycache__").write_text("", encoding="utf-8")  # there can be no folder
    assert kernel_of()(3.0) == 6.0
    assert list((tmp_path / "users").rglob("*.nbi")) == list(tmp_path.rglob("*.nbi")) != []
    shutil.rmtree(tmp_path / "users")
    (tmp_path / "users").write_text("", encoding="utf-8")
    assert kernel_of()(3.0) == 6.0
    assert not list(tmp_path.rglob("*.nbi"))
