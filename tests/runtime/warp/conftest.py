import pytest
import warp as wp


@pytest.fixture(scope="session", autouse=True)
def compiled_quickly():
    """Compile kernels without optimising them, which takes half as long."""
    kept = wp.config.optimization_level
    wp.config.optimization_level = 0
    yield
    wp.config.optimization_level = kept
