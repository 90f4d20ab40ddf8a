// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "pose/graph/chunk_memory.hpp"

namespace orchard::mapping {

using pose::ChunkMemory;
using pose::HeapMemory;

}  // namespace orchard::mapping
