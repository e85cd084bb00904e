"""Order of the files: for workers of pytest-xdist that take a file at a time."""

#: Those that take half a minute and more, the longest first, so that two workers come to the end together.
LONGEST = (
    "test_reconstruct",
    "test_code_blocks",
    "test_scan",
    "test_new_session",
    "test_consumer",
    "test_calibrate",
    "test_edit_segmentation",
    "test_view",
)


def pytest_collection_modifyitems(items):
    place = {name: i for i, name in enumerate(LONGEST)}
    items.sort(key=lambda item: place.get(item.path.stem, len(LONGEST)))
