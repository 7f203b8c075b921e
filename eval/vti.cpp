// SPDX-License-Identifier: Apache-2.0
#include "eval/vti.h"

#include <bit>
#include <cstdint>
#include <cstdio>
#include <vector>

#include "core/error.h"
#include "core/files.h"
#include "eval/html_text.h"

namespace vecino {
namespace {

std::string attribute(const char* name, const std::string& value) {
    return std::string(" ") + name + "=\"" + escaped(value) + "\"";
}

std::string number(double value) {
    char text[40];
    std::snprintf(text, sizeof text, "%.17g", value);
    return text;
}

/// Field arrays of strings hold the codes of their characters, each string ended by a 0.
std::string character_codes(const std::string& text) {
    std::string codes;
    for (const char c : text) codes += std::to_string(static_cast<unsigned char>(c)) + " ";
    return codes + "0 ";
}

std::string definition_line(const VtiArray& array) {
    const std::string unit = array.unit.empty() ? "" : " [" + array.unit + "]";
    return array.name + unit + ": " + array.definition;
}

std::string field_data(const VtiImage& image) {
    std::string text = "    <FieldData>\n";
    for (const VtiNumber& each : image.numbers) {
        text += "      <DataArray type=\"Float64\"" + attribute("Name", each.name) +
                " NumberOfTuples=\"1\" format=\"ascii\">" + number(each.value) + "</DataArray>\n";
    }
    text += "      <Array type=\"String\" Name=\"definitions\" NumberOfTuples=\"" +
            std::to_string(image.arrays.size()) + "\" format=\"ascii\">\n";
    for (const VtiArray& array : image.arrays)
        text += "        " + character_codes(definition_line(array)) + "\n";
    return text + "      </Array>\n    </FieldData>\n";
}

std::uint64_t byte_count(const VtiImage& image, const VtiArray& array) {
    return image.size.area() * array.component_count() * sizeof(float);
}

std::string array_head(const VtiArray& array, std::uint64_t offset) {
    std::string text = "        <DataArray type=\"Float32\"" + attribute("Name", array.name) +
                       attribute("NumberOfComponents", std::to_string(array.component_count()));
    for (std::size_t i = 0; i < array.components.size(); ++i) {
        const std::string name = "ComponentName" + std::to_string(i);
        text += attribute(name.c_str(), std::string(array.components[i]));
    }
    text += " format=\"appended\" offset=\"" + std::to_string(offset) + "\"";
    if (array.unit.empty()) return text + "/>\n";
    return text + ">\n          <InformationKey name=\"UNITS_LABEL\" location=\"vtkDataArray\">" +
           escaped(array.unit) + "</InformationKey>\n        </DataArray>\n";
}

std::string head(const VtiImage& image) {
    const std::string extent = "0 " + std::to_string(image.size.width - 1) + " 0 " +
                               std::to_string(image.size.height - 1) + " 0 0";
    const char* order = std::endian::native == std::endian::little ? "LittleEndian" : "BigEndian";
    std::string text =
        "<?xml version=\"1.0\"?>\n"
        "<VTKFile type=\"ImageData\" version=\"1.0\" byte_order=\"" +
        std::string(order) + "\" header_type=\"UInt64\">\n  <ImageData WholeExtent=\"" + extent +
        "\" Origin=\"0 0 0\" Spacing=\"1 1 1\">\n" + field_data(image) + "    <Piece Extent=\"" +
        extent + "\">\n      <PointData" + attribute("Scalars", image.shown) + ">\n";
    std::uint64_t offset = 0;
    for (const VtiArray& array : image.arrays) {
        text += array_head(array, offset);
        offset += sizeof(std::uint64_t) + byte_count(image, array);
    }
    return text +
           "      </PointData>\n    </Piece>\n  </ImageData>\n  <AppendedData "
           "encoding=\"raw\">\n   _";
}

/// From the bottom row up.
void write_values(std::FILE* stream, const VtiImage& image, const VtiArray& array) {
    const auto width = static_cast<std::size_t>(image.size.width);
    const std::size_t components = array.component_count();
    std::vector<float> row(width * components);
    for (auto y = static_cast<std::size_t>(image.size.height); y-- > 0;) {
        float* to = row.data();
        for (std::size_t x = 0; x < width; ++x) {
            for (std::size_t c = 0; c < components; ++c) *to++ = array.value(y * width + x, c);
        }
        std::fwrite(row.data(), sizeof(float), row.size(), stream);
    }
}

}  // namespace

void save_vti(const VtiImage& image, const std::string& path) {
    if (image.size.area() == 0)
        throw Error(ExitCode::mismatch, path + ": found an image without pixels, allowed: 1x1 on");
    TemporaryFile file(path);
    const std::string text = head(image);
    std::fwrite(text.data(), 1, text.size(), file.stream());
    for (const VtiArray& array : image.arrays) {
        const std::uint64_t bytes = byte_count(image, array);
        std::fwrite(&bytes, sizeof bytes, 1, file.stream());
        write_values(file.stream(), image, array);
    }
    std::fputs("\n  </AppendedData>\n</VTKFile>\n", file.stream());
    file.replace_target();
}

}  // namespace vecino
