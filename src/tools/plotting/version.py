"""The version of the package that this program belongs to."""

import os
import xml.etree.ElementTree

# package.xml relative to this folder: in the source tree, and in an installation.
MANIFESTS = ("../../../package.xml", "../../../share/stochastic_platoon/package.xml")


def package_version():
    for manifest in MANIFESTS:
        path = os.path.join(os.path.dirname(os.path.realpath(__file__)), manifest)
        if os.path.exists(path):
            return xml.etree.ElementTree.parse(path).findtext("version")
    return "unknown"
