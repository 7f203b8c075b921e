# SPDX-License-Identifier: Apache-2.0
"""Prints the values that test_metric_pins.cpp holds ms_ssim, flip, hdr_flip and smape to.

They come from the authors' or other programs, not from vecino. Run by hand, in an environment with
    pip install numpy flip-evaluator==1.7 pytorch-msssim==1.0.0 tensorflow-cpu==2.21.0
(those that are not there are left out).
"""
import numpy as np


def hash8(x, y, c, seed):
    h = (x * 73856093 ^ y * 19349663 ^ c * 83492791 ^ seed * 2654435761) & 0xFFFFFFFF
    h = (h ^ h >> 13) * 0x5BD1E995 & 0xFFFFFFFF
    return (h ^ h >> 15) & 255


def noise(x, y, c, seed):
    return hash8(x, y, c, seed)


def patches(x, y, c, seed):
    """Coloured patches with steps and points; a seed moves their borders and adds noise."""
    patch = ((x + seed) // 11 + y // 7) % 3
    point = 70 if x % 13 == 5 and y % 9 == 4 * (seed % 2) else 0
    return 20 + 60 * ((patch + c) % 3) + point + hash8(x, y, c, seed) % 24


def image(pattern, width, height, seed):
    return np.uint8([[[pattern(x, y, c, seed) for c in range(3)] for x in range(width)] for y in range(height)])


def pair(pattern, width, height):
    """Test and reference."""
    return image(pattern, width, height, 2), image(pattern, width, height, 1)


def hdr(pixels):
    """Linear, up to 15.9, exact in 32 bits."""
    return np.float32(pixels.astype(np.float64) ** 2 / 4096)


def print_ms_ssim():
    try:
        import torch
        from pytorch_msssim import ms_ssim
        # Its own window is rounded to 32 bits, and its 2x2 means take zeros into a last odd row or column: multiples of
        # 16 only.
        window = torch.exp(-(torch.arange(-5, 6, dtype=torch.float64) ** 2) / (2 * 1.5**2))
        window = (window / window.sum()).repeat(3, 1, 1, 1)
        for pattern, w, h in (patches, 176, 192), (noise, 192, 176):
            t, r = (torch.tensor(p.astype(np.float64)).permute(2, 0, 1)[None] for p in pair(pattern, w, h))
            print("pytorch_msssim", pattern.__name__, w, h, repr(ms_ssim(t, r, data_range=255, win=window).item()))
    except ImportError as error:
        print(error)
    try:
        import tensorflow as tf
        for pattern, w, h in (patches, 176, 192), (patches, 161, 163):
            t, r = (tf.constant(p) for p in pair(pattern, w, h))
            print("tensorflow", pattern.__name__, w, h, tf.image.ssim_multiscale(t, r, 255).numpy())
    except ImportError as error:
        print(error)


def print_flip():
    try:
        import flip_evaluator
    except ImportError as error:
        print(error)
        return
    parameters = {"vc": [0.7, 3840, 0.7]}
    exposures = {"startExposure": -4.0, "stopExposure": 4.0, "numExposures": 8, "tonemapper": "aces"}
    for pattern, w, h in (patches, 48, 40), (noise, 33, 21), (patches, 5, 7), (patches, 1, 1):
        t, r = pair(pattern, w, h)
        encoded = [np.float32(p) / np.float32(255) for p in (r, t)]
        for name, inputs, options, is_srgb in (
            ("LDR", encoded, parameters, True), ("HDR", [hdr(r), hdr(t)], parameters | exposures, False)
        ):
            result, mean, _ = flip_evaluator.evaluate(*inputs, name, inputsRGB=is_srgb, applyMagma=False, parameters=options)
            values = np.asarray(result).reshape(h, w)
            print(name, pattern.__name__, w, h, repr(float(np.mean(values, dtype=np.float64))),
                  [float(values[y, x]) for x, y in ((0, 0), (w // 2, h // 2), (w - 1, h - 1))])


def print_smape():
    for pattern, w, h in (patches, 48, 40), (noise, 33, 21):
        t, r = (hdr(p).astype(np.float64) for p in pair(pattern, w, h))
        print("smape", pattern.__name__, w, h, repr(float(np.mean(np.abs(t - r) / (np.abs(t) + np.abs(r) + 0.01)))))


print_ms_ssim()
print_flip()
print_smape()
