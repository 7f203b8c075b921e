// SPDX-License-Identifier: Apache-2.0
//
// Reads .vti files as their format describes them, with nothing of the writer.
#pragma once

#include <cstdint>
#include <cstring>
#include <map>
#include <regex>
#include <stdexcept>
#include <string>
#include <vector>

#include "core/files.h"
#include "core/grid.h"

namespace vecino {

struct VtiArrayRead {
    std::size_t components = 0;
    std::string tag;            ///< the start tag
    std::vector<float> values;  ///< bottom row first, components of a point side by side
};

struct VtiRead {
    Extent size;
    std::string head;  ///< the XML up to the data
    std::string tail;  ///< what follows the last array
    std::map<std::string, VtiArrayRead> arrays;
    std::vector<std::string> order;

    /// Of a pixel that is counted from the top.
    [[nodiscard]] float at(const std::string& array, int x, int y,
                           std::size_t component = 0) const {
        const VtiArrayRead& read = arrays.at(array);
        const auto row = static_cast<std::size_t>(size.height - 1 - y);
        const std::size_t point =
            row * static_cast<std::size_t>(size.width) + static_cast<std::size_t>(x);
        return read.values.at(point * read.components + component);
    }
};

inline std::string attribute_of(const std::string& tag, const std::string& name) {
    std::smatch found;
    if (std::regex_search(tag, found, std::regex(" " + name + "=\"([^\"]*)\""))) return found[1];
    throw std::runtime_error(tag + " has no " + name);
}

inline VtiRead read_vti(const std::string& path) {
    const std::string bytes = read_file(path);
    const std::string mark = "<AppendedData encoding=\"raw\">";
    const std::size_t appended = bytes.find(mark);
    if (appended == std::string::npos) throw std::runtime_error(path + ": no appended data");
    const std::size_t data = bytes.find('_', appended) + 1;
    VtiRead read;
    read.head = bytes.substr(0, appended);
    std::smatch extent;
    if (!std::regex_search(read.head, extent, std::regex("WholeExtent=\"0 (\\d+) 0 (\\d+) 0 0\"")))
        throw std::runtime_error(path + ": no extent");
    read.size = {std::stoi(extent[1]) + 1, std::stoi(extent[2]) + 1};
    const std::string points = read.head.substr(read.head.find("<PointData"));
    const std::regex tags("<DataArray [^>]*>");
    std::size_t end = data;
    for (auto i = std::sregex_iterator(points.begin(), points.end(), tags);
         i != std::sregex_iterator(); ++i) {
        VtiArrayRead array;
        array.tag = i->str();
        array.components = std::stoul(attribute_of(array.tag, "NumberOfComponents"));
        const std::size_t offset = data + std::stoul(attribute_of(array.tag, "offset"));
        std::uint64_t count = 0;
        std::memcpy(&count, bytes.substr(offset, sizeof count).data(), sizeof count);
        if (offset != end || count % sizeof(float) != 0 ||
            offset + sizeof count + count > bytes.size())
            throw std::runtime_error(path + ": an array that does not follow the last one");
        array.values.resize(count / sizeof(float));
        std::memcpy(array.values.data(), bytes.data() + offset + sizeof count, count);
        end = offset + sizeof count + count;
        read.order.push_back(attribute_of(array.tag, "Name"));
        read.arrays[read.order.back()] = std::move(array);
    }
    read.tail = bytes.substr(end);
    return read;
}

}  // namespace vecino
