"""What the network learns from: heights of mean 0 and deviation 1; pictures that are Lambert's where they can be checked by hand.

Most of it needs torch, which is an extra, in a process without Dr.Jit: those tests run where it is installed.
"""

import math

import numpy as np
import pytest

from voldetail.training import heights


def test_the_pool_is_the_same_for_the_same_seed() -> None:
    one, other = heights.pool(6, 3), heights.pool(6, 3)
    assert np.array_equal(one, other)
    assert one.shape == (6, heights.SIDE, heights.SIDE)
    assert np.abs(one.astype(np.float64).mean(axis=(1, 2))).max() < 0.01
    assert np.abs(one.astype(np.float64).std(axis=(1, 2)) - 1).max() < 0.01


@pytest.mark.parametrize("maker", heights.MAKERS, ids=lambda maker: maker.__name__)
def test_every_maker_makes_relief(maker: heights.Maker) -> None:
    made = maker(np.random.default_rng(5))
    assert made.shape == (heights.SIDE, heights.SIDE)
    assert np.isfinite(made).all()
    assert made.std() > 1e-3


class TestWithTorch:
    @pytest.fixture(autouse=True)
    def _torch(self) -> None:
        pytest.importorskip("torch", reason="torch is an extra")

    def test_a_flat_surface_reflects_what_it_gets(self) -> None:
        import torch

        from voldetail.training.shade import parts

        height = torch.zeros(1, 32, 32)
        light = torch.tensor([0.6, 0.0, 0.8]).view(1, 3, 1, 1).expand(1, 3, 32, 32)
        ambient, diffuse, _ = parts(height, light, torch.ones(1, 32, 32), torch.tensor([20.0]))
        assert torch.allclose(ambient, torch.ones(1, 32, 32), atol=1e-4)
        assert torch.allclose(diffuse, torch.full((1, 32, 32), 0.8), atol=1e-5)

    def test_a_wall_casts_a_shadow_of_the_right_length(self) -> None:
        """A wall 6 pixels high under light from the right at 45 degrees: some 5 pixels to its left are dark, not 10.

        (Steps towards the light are up to 2 pixels apart there, so that the shadow's end is not exact.)
        """
        import torch

        from voldetail.training.shade import lit

        height = torch.zeros(1, 64, 64)
        height[:, :, 32:36] = 6.0
        side = math.sqrt(0.5)
        found = lit(height, torch.tensor([[side, 0.0, side]]))[0, 32]
        assert (found[28:31] < 0.1).all()
        assert (found[10:22] > 0.4).all()
        assert (found[40:50] > 0.4).all()

    def test_the_linear_step_is_that_of_recover(self) -> None:
        import torch

        from tests.unit.relief_examples import smooth_noise
        from voldetail.recover.linear import slopes_under
        from voldetail.recover.network import SLOWEST, relative
        from voldetail.training.samples import linear_slopes

        log = 0.2 * smooth_noise((160, 160), 8.0)
        light = np.array([0.5, 0.3, math.sqrt(1 - 0.34)], np.float32)
        said = torch.from_numpy(light).view(1, 3, 1, 1).expand(1, 3, 160, 160)
        p, q = linear_slopes(torch.from_numpy(log)[None], said)[0].numpy()
        wanted = slopes_under(relative(log), tuple(float(v) for v in light), SLOWEST, parted=False)
        inner = (slice(30, -30), slice(30, -30))
        assert np.corrcoef(p[inner].ravel(), wanted.p[inner].ravel())[0, 1] > 0.99
        assert np.corrcoef(q[inner].ravel(), wanted.q[inner].ravel())[0, 1] > 0.97

    def test_features_are_those_of_recover(self) -> None:
        import torch

        from tests.unit.relief_examples import smooth_noise
        from voldetail.recover.network import features as own
        from voldetail.training.samples import features

        photo = 0.3 + 0.05 * np.stack([smooth_noise((128, 128), 8.0, k) for k in range(3)], axis=-1).astype(np.float32)
        found = features(torch.from_numpy(photo).permute(2, 0, 1)[None])[0].permute(1, 2, 0).numpy()
        assert np.allclose(found, own(photo), atol=2e-3)

    def test_samples_and_one_step(self) -> None:
        from voldetail.training.model import ReliefNet
        from voldetail.training.samples import SIDE, make_batch
        from voldetail.training.train import loss_of

        pool = heights_of_noise(4)
        one, other = make_batch(pool, 2, 9), make_batch(pool, 2, 9)
        assert one.features.shape == (2, 8, SIDE, SIDE)
        assert (one.features == other.features).all()
        loss, angle = loss_of(ReliefNet()(one.features), one)
        loss.backward()
        assert math.isfinite(float(loss.detach()))
        assert 0 < float(angle) < 90

    def test_weights_run_alike_in_numpy(self) -> None:
        import torch

        from voldetail.recover.network_layers import run
        from voldetail.training.model import INPUTS, ReliefNet

        torch.manual_seed(0)
        net = ReliefNet()
        x = np.random.default_rng(0).normal(size=(48, 64, INPUTS)).astype(np.float32)
        wanted = net(torch.from_numpy(x).permute(2, 0, 1)[None])[0].permute(1, 2, 0).detach().numpy()
        found = run(x, {name: value.numpy() for name, value in net.state_dict().items()})
        assert np.allclose(found, wanted, atol=1e-4)


def heights_of_noise(count: int) -> np.ndarray:
    """Heights made without Dr.Jit, which torch does not share a process with."""
    rng = np.random.default_rng(1)
    return np.stack([heights.normalised(heights.spectral(rng)) for _ in range(count)])
