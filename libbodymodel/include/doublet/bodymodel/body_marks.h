#pragma once
// Deprecated, for one minor version: include "doublet/bodymodel/detect_joints.h".

#include "doublet/bodymodel/detect_joints.h"
