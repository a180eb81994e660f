#include "base/utf8.h"

#include "base/json.h"

namespace vpr {

bool is_utf8(const std::string& text) {
  try {
    (void)Json(text).dump();
    return true;
  } catch (const Json::type_error&) {
    return false;
  }
}

}  // namespace vpr
