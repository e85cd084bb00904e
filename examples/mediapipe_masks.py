"""Masks and keypoints of one person in a video of a camera that stands still, where there is no screen: MediaPipe Pose finds the
person, OpenCV's GrabCut the edge. Both are yours to install; doublet does not need them:

    python3 -m venv masks_venv && masks_venv/bin/pip install mediapipe==0.10.21   # brings OpenCV and NumPy; Python 3.9 to 3.12
    masks_venv/bin/python examples/mediapipe_masks.py cam01.mp4 -o masks/cam01 --keypoints keypoints/cam01.json

Its larger network is a little better: `npm pack @mediapipe/pose@0.5.1675469404`, and put package/pose_landmark_heavy.tflite of
the archive into mediapipe/modules/pose_landmark of the installed package.
"""

import argparse
import json
from pathlib import Path

import cv2
import mediapipe
import numpy as np

VIEWS = ((False, 0), (False, 20), (False, -20), (True, 0))  # mirrored, turned by degrees: their mean is steadier than any
MARGIN = 30  # px around the person that GrabCut sees


def network_masks(pose, image):
    """(2, H, W) uint8: mean and maximum of the network's masks of all views; (33, 3) x, y in pixels and visibility, or None."""
    rgb, (height, width) = cv2.cvtColor(image, cv2.COLOR_BGR2RGB), image.shape[:2]
    masks, points = [], []
    for mirrored, angle in VIEWS:
        view = np.array([[-1.0, 0, width - 1], [0, 1, 0]])
        if not mirrored:
            view = cv2.getRotationMatrix2D((width / 2, height / 2), angle, 1)
        found = pose.process(cv2.warpAffine(rgb, view, (width, height), borderMode=cv2.BORDER_REPLICATE))
        if found.pose_landmarks is None:
            continue
        masks.append(
            cv2.warpAffine(found.segmentation_mask, view, (width, height), flags=cv2.INTER_LINEAR | cv2.WARP_INVERSE_MAP)
        )
        if not mirrored:
            seen = np.array([[p.x * width, p.y * height, p.visibility] for p in found.pose_landmarks.landmark])
            points.append(np.c_[cv2.transform(seen[None, :, :2], cv2.invertAffineTransform(view))[0], seen[:, 2]])
    masks = masks or [np.zeros((height, width), np.float32)]
    both = (255 * np.array([np.mean(masks, axis=0), np.max(masks, axis=0)])).astype(np.uint8)
    return both, np.median(points, axis=0).round(3).tolist() if points else None


def clean_plate(frames, masks, rows=32):
    """The scene without the person: median of each pixel over the frames with no mask near it; 0 where it is never seen."""
    near = [cv2.dilate(most, np.ones((41, 41), np.uint8)) > 64 for _, most in masks]
    plate = np.zeros(frames[0].shape, np.float32)
    for y in range(0, len(plate), rows):  # a few rows at a time: memory
        seen = [np.where(n[y : y + rows, :, None], np.nan, f[y : y + rows]) for f, n in zip(frames, near)]
        plate[y : y + rows] = np.nan_to_num(np.nanmedian(np.array(seen, np.float32), axis=0))
    return plate


def refined(image, masks, plate):
    """(H, W) uint8, 255 = person: GrabCut in a narrow band about the network's edge, helped by the difference to the plate."""
    mask = np.zeros(image.shape[:2], np.uint8)
    x, y, width, height = cv2.boundingRect((masks[1] > 127).astype(np.uint8))
    if width == 0:
        return mask
    box = np.s_[max(y - MARGIN, 0) : y + height + MARGIN, max(x - MARGIN, 0) : x + width + MARGIN]
    image, (mean, most), plate = image[box].copy(), masks[(slice(None), *box)], plate[box]
    change = np.abs(cv2.GaussianBlur(image, (0, 0), 1).astype(np.float32) - cv2.GaussianBlur(plate, (0, 0), 1)).max(axis=2)
    known = cv2.erode(plate.max(axis=2), np.ones((5, 5))) > 0
    coarse = ((mean > 127) | ((most > 127) & known & (change > 30))).astype(np.uint8)
    inside, outside = (cv2.distanceTransform(m, cv2.DIST_L2, 5) for m in (coarse, 1 - coarse))
    label = np.where(coarse, cv2.GC_PR_FGD, cv2.GC_PR_BGD).astype(np.uint8)
    label[known & (change < 8) & (inside < 5)] = cv2.GC_BGD
    label[known & (change > 45) & (outside < 6)] = cv2.GC_FGD
    label[inside > 10], label[outside > 14] = cv2.GC_FGD, cv2.GC_BGD
    cv2.grabCut(image, label, None, np.zeros((1, 65)), np.zeros((1, 65)), 2, cv2.GC_INIT_WITH_MASK)
    mask[box] = cv2.medianBlur(label & 1, 5)
    for value, smallest in ((0, 100), (1, 0.02 * mask.sum())):  # px: pinholes are filled, specks dropped
        _, parts, stats, _ = cv2.connectedComponentsWithStats((mask == value).astype(np.uint8), connectivity=4)
        mask[(stats[:, cv2.CC_STAT_AREA] < smallest)[parts] & (mask == value)] = 1 - value
    return 255 * mask


def read_frames(video):
    capture = cv2.VideoCapture(str(video))
    while True:
        found, frame = capture.read()
        if not found:
            return
        yield frame


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("video", type=Path)
    parser.add_argument("-o", "--out", type=Path, required=True, help="folder of the masks, one image for each frame")
    parser.add_argument("--keypoints", type=Path, help="JSON for doublet scan --keypoints")
    arguments = parser.parse_args()
    if not hasattr(mediapipe, "solutions"):
        found = getattr(mediapipe, "__version__", "another version")
        parser.error(
            f"expected MediaPipe 0.10.21, the last with its networks inside, found {found}; it needs Python 3.9 to 3.12: "
            "python3.12 -m venv masks_venv && masks_venv/bin/pip install mediapipe==0.10.21"
        )
    frames = list(read_frames(arguments.video))
    if not frames:
        parser.error(f"{arguments.video}: expected a video, found no frame")
    larger = (Path(mediapipe.__file__).parent / "modules/pose_landmark/pose_landmark_heavy.tflite").exists()
    pose = mediapipe.solutions.pose.Pose(
        static_image_mode=True, model_complexity=2 if larger else 1, enable_segmentation=True, min_detection_confidence=0.2
    )
    found = []
    for number, frame in enumerate(frames):
        found.append(network_masks(pose, frame))
        print(f"\r{arguments.video.name}: {number + 1} of {len(frames)}", end="", flush=True)
    print()
    masks, points = zip(*found)
    plate = clean_plate(frames[::4], masks[::4])
    arguments.out.mkdir(parents=True, exist_ok=True)
    for number, (frame, both) in enumerate(zip(frames, masks)):
        cv2.imwrite(str(arguments.out / f"{number:04d}.png"), refined(frame, both, plate))
    if arguments.keypoints:
        arguments.keypoints.parent.mkdir(parents=True, exist_ok=True)
        arguments.keypoints.write_text(json.dumps(points))


if __name__ == "__main__":
    main()
