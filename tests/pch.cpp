// SPDX-License-Identifier: BSD-3-Clause
// Holds nothing: the target that compiles the precompiled headers needs a source file.
