"""Training as in Appendix A: Adam, two losses, the best checkpoint; then calibration, then ONNX.

The category loss is that of true edges only; validity and category weigh 2/3 and 1/3, also in the
validation loss that chooses the checkpoint.
"""

from __future__ import annotations

import copy
import io
import math
import warnings
from collections.abc import Iterator
from typing import Any

import numpy as np
import torch
from torch import Tensor, nn
from torch.nn import functional

from prunus.lab.learn.edges.examples import Example
from prunus.lab.learn.edges.labels import SOME, UNTOLD
from prunus.lab.learn.edges.logistic import fit_logistic
from prunus.lab.learn.edges.net import VALIDITY, Calibrated
from prunus.lab.learn.edges.recipes import INPUTS, Recipe
from prunus.model import Floats, Ints

SHARES = (2 / 3, 1 / 3)
"""Weights of the validity and the category loss."""


def losses(found: Tensor, category: Tensor) -> tuple[Tensor, Tensor]:
    """Cross entropy of validity over all edges, and of the category over the valid ones.

    Over those of which it was told, that is.
    """
    told, named = category > UNTOLD, (category >= 0) & (category < SOME)
    if not told.any():
        return 0 * found.sum(), 0 * found.sum()
    validity = functional.cross_entropy(found[told, :VALIDITY], (category[told] >= 0).long())
    if not named.any():
        return validity, 0 * validity
    kind = functional.cross_entropy(found[named, VALIDITY:], category[named])
    return validity, kind


def combined(found: Tensor, category: Tensor) -> Tensor:
    """The two losses in their shares."""
    validity, kind = losses(found, category)
    return SHARES[0] * validity + SHARES[1] * kind


def train(
    recipe: Recipe, training: list[Example], validation: list[Example], rng: np.random.Generator
) -> Iterator[tuple[nn.Module, float]]:
    """The best network so far and its validation loss, after each epoch."""
    torch.manual_seed(int(rng.integers(2**31)))
    torch.use_deterministic_algorithms(True)
    net = recipe.network()
    steps = sum(1 for _ in recipe.batches(training, np.random.default_rng(0)))
    optimizer = torch.optim.Adam(net.parameters(), recipe.rate)
    slower = torch.optim.lr_scheduler.OneCycleLR(
        optimizer, recipe.rate, total_steps=steps * recipe.epochs + 1
    )
    best, least = copy.deepcopy(net), math.inf
    for _ in range(recipe.epochs):
        net.train()
        for inputs, category in recipe.batches(training, rng):
            optimizer.zero_grad()
            combined(net(*inputs), category).backward()  # type: ignore[no-untyped-call]
            nn.utils.clip_grad_norm_(net.parameters(), 1.0)
            optimizer.step()
            slower.step()
        loss = validation_loss(net, recipe, validation)
        if loss < least:
            best, least = copy.deepcopy(net), loss
        yield best, loss


@torch.no_grad()
def validation_loss(net: nn.Module, recipe: Recipe, examples: list[Example]) -> float:
    """The combined loss, mean over the examples."""
    net.eval()
    found = [float(combined(net(*seen), category)) for seen, category in recipe.judged(examples)]
    return float(np.mean(found))


def finished(net: nn.Module, recipe: Recipe, validation: list[Example]) -> Calibrated:
    """The network as it ships.

    One that went on from another ends between the two: with 700 labels of scans unlike those
    that ours learned from that kept all of the gain, and of scans just like those it cost nothing,
    where all the way cost half a point. It stays calibrated as the other was: the edges that
    people label are those that it could not tell, of which no stretch can be learned.
    """
    if recipe.start is not None:
        return Calibrated(between(recipe.network(), net, LEARNED), 1.0, 0.0)
    return calibrated(net, recipe, validation)


LEARNED = 0.6
"""A network that goes on from another keeps so large a share of what it learned."""


@torch.no_grad()
def between(one: nn.Module, other: nn.Module, share: float) -> nn.Module:
    """The network whose parameters lie so far from one to the other."""
    ours, theirs = one.state_dict(), other.state_dict()
    numbers = [name for name, own in ours.items() if own.is_floating_point()]
    one.load_state_dict(ours | {n: torch.lerp(ours[n], theirs[n], share) for n in numbers})
    return one


@torch.no_grad()
def calibrated(net: nn.Module, recipe: Recipe, examples: list[Example]) -> Calibrated:
    """The network with its log odds stretched and shifted to fit the validation examples.

    Platt scaling.
    """
    net.eval()
    pairs = [(net(*seen), category) for seen, category in recipe.judged(examples)]
    found = torch.cat([one for one, _ in pairs])
    category = torch.cat([own for _, own in pairs]).numpy()
    told = category > UNTOLD
    odds = (found[:, 1] - found[:, 0]).double().numpy()[told]
    stretch, shift = fit_logistic(odds[:, None], category[told] >= 0)
    return Calibrated(net, float(stretch), float(shift))


@torch.no_grad()
def predict(net: Calibrated, recipe: Recipe, examples: list[Example]) -> tuple[Floats, Ints, Ints]:
    """Confidence (E,), likeliest category (E,) and the true one (E,) of the edges judged.

    Of those of which it was told.
    """
    net.eval()
    found = [(*net(*seen), category) for seen, category in recipe.judged(examples)]
    confidence, category, truth = (torch.cat(column) for column in zip(*found, strict=True))
    told = truth > UNTOLD
    likeliest = category[told].argmax(dim=1)
    return confidence[told].double().numpy(), likeliest.numpy(), truth[told].numpy()


def onnx_bytes(net: Calibrated, recipe: Recipe, example: Example) -> bytes:
    """The network as an ONNX file, for any number of edges."""
    inputs, _ = recipe.seen(example)
    return exported(net, inputs, INPUTS, ("confidence", "category"), "edges")


def exported(
    net: nn.Module,
    inputs: tuple[Tensor, ...],
    names: tuple[str, ...],
    outputs: tuple[str, ...],
    counted: str,
) -> bytes:
    """A network as an ONNX file, for any number of what its inputs and outputs count first."""
    held: Any = io.BytesIO()
    with warnings.catch_warnings():
        # The older exporter warns that there is a newer one, which needs one more package.
        warnings.simplefilter("ignore")
        torch.onnx.export(
            net.eval(), inputs, held, input_names=list(names), output_names=list(outputs),
            dynamic_axes={one: {0: counted} for one in (*names, *outputs)},
            opset_version=18, dynamo=False,
        )  # fmt: skip
    return bytes(held.getvalue())
