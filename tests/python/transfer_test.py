"""transfer() against the command."""

import json

import pytest

import sonarcal
from conftest import PARAMETERS

NOTHING = {"A": 0, "B_deg": 4, "C": 0, "D": 1, "E": 0, "F_deg": 10}
# Bright where the box echoes, dark elsewhere.
MASKS = {**PARAMETERS, "display": {"db_min": 0, "db_max": 1},
         "materials": {"floor": {"gsab": NOTHING}, "box": {"gsab": {**NOTHING, "C": 100}}}}


@pytest.fixture(scope="module")
def masks(world):
    file = world.folder / "masks.json"
    sonarcal.write_parameters(MASKS, file)
    return world.simulate_command("masks", "--expected", params=file)


@pytest.fixture(scope="module")
def trained(world):
    return world.simulate_command("trained", "--noise", "--seed", "7", "--bits", "12")


def test_equals_the_command(world, recorded, trained, masks, tmp_path):
    words = ["transfer", "--train", trained, "--test", recorded, "--test-masks", masks, "--json", "--quiet"]
    by_object = json.loads(world.command(*words, "--object", "box", "--out", tmp_path / "out"))
    found = sonarcal.transfer(trained, recorded, masks, object="box")
    assert found == by_object == json.loads((tmp_path / "out" / "transfer.json").read_text())
    opened = [sonarcal.open_recording(each) for each in (trained, recorded, masks)]
    assert sonarcal.transfer(opened[0], [opened[1]], [opened[2]], {"object": "box"}) == found
    by_masks = json.loads(world.command(*words, "--train-masks", masks))
    assert sonarcal.transfer([trained], recorded, masks, train_masks=masks) == by_masks


def test_a_result_has_figures_table_and_curves(recorded, trained, masks):
    found = sonarcal.transfer(trained, recorded, masks, object="box")
    assert found.trained_on_training["average_precision"]["value"] > 2 * found["object_share"]
    assert found.difference["iou"]["value"] == pytest.approx(
        found.trained_on_training["iou"]["value"] - found.trained_on_test_blocks["iou"]["value"])
    assert repr(found).startswith("TransferResult(4 test frames, difference in average precision ")
    assert "average_precision" in found._repr_html_() and " to " in found._repr_html_()
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("Agg")
    lines = found.plot().axes[0].lines
    assert [line.get_label() for line in lines] == [
        "trained on training recordings", "trained on other test frames", "guessing"]


def test_mistakes_are_named(recorded, trained, masks):
    with pytest.raises(sonarcal.UsageError, match="expected either train_masks or object"):
        sonarcal.transfer(trained, recorded, masks)
    with pytest.raises(sonarcal.UsageError, match="test_masks names 2 recordings, expected 1"):
        sonarcal.transfer(trained, recorded, [masks, masks], object="box")
    with pytest.raises(sonarcal.DataError, match="no material 'bix'"):
        sonarcal.transfer(trained, recorded, masks, object="bix")
