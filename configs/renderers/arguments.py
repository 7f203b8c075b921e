# SPDX-License-Identifier: Apache-2.0
"""What the scripts of this folder are asked."""
import argparse


def size(text):
    return tuple(int(side) for side in text.split("x"))


def render_arguments(description):
    """Of a script that renders a scene."""
    parser = argparse.ArgumentParser(description=description, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scene")
    parser.add_argument("output")
    parser.add_argument("--size", type=size, required=True)
    parser.add_argument("--spp", type=int, required=True)
    parser.add_argument("--max-depth", type=int, required=True)
    parser.add_argument("--seed", type=int, required=True)
    parser.add_argument("--planes", choices=["none", "emission", "guide"], default="none")
    return parser.parse_args()
