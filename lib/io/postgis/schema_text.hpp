// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace orchard::io {

/// Content of orchard_schema.sql.
const char* schema_text();

}  // namespace orchard::io
