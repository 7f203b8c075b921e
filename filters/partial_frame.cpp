// SPDX-License-Identifier: Apache-2.0
#include "filters/partial_frame.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "core/memory.h"
#include "core/parallel.h"
#include "core/render_task.h"

namespace vecino {
namespace {

constexpr std::size_t kPixelsPerBlock = 1024;
// Below this albedo, light cannot be told from what its surface sends on.
constexpr double kLeastAlbedo = 1e-3;

const RenderSettings& checked(const RenderSettings& settings) {
    check_settings(settings);
    return settings;
}

/// Planes asked for, and those that a partial frame works with.
Planes planes_to_keep(const RenderSettings& settings, VarianceOf variance_of) {
    Planes planes = planes_to_make(settings);
    if (variance_of != VarianceOf::nothing) planes.add(Plane::variance);
    planes.add({Plane::emission, Plane::direct, Plane::indirect, Plane::count});
    return planes;
}

glm::vec3 albedo_of(const FirstHitRecord& hit) {
    return {hit.albedo[0], hit.albedo[1], hit.albedo[2]};
}

}  // namespace

// ---------------------------------------------------------------- blends

void Blend::add(const Frame& from, std::size_t pixel, const FirstHitRecord& hit, double weight) {
    weight_ += weight;
    emission_ += weight * glm::dvec3(from.emission.values()[pixel]);
    direct_ += weight * glm::dvec3(from.direct.values()[pixel]);
    indirect_ += weight * glm::dvec3(from.indirect.values()[pixel]);
    albedo_ += weight * glm::dvec3(albedo_of(hit));
    if (!from.variance.empty())
        variance_ += weight * weight * glm::dvec3(from.variance.values()[pixel]);
}

PixelValues Blend::values(std::optional<glm::vec3> albedo) const {
    PixelValues values;
    values.emission = glm::vec3(emission_ / weight_);
    for (int c = 0; c < 3; ++c) {
        const bool demodulates = albedo && albedo_[c] > kLeastAlbedo * weight_;
        const double scale =
            demodulates ? static_cast<double>((*albedo)[c]) / albedo_[c] : 1.0 / weight_;
        values.direct[c] = static_cast<float>(direct_[c] * scale);
        values.indirect[c] = static_cast<float>(indirect_[c] * scale);
        values.variance[c] = static_cast<float>(variance_[c] * scale * scale);
    }
    return values;
}

namespace {

/// Of a source, from its distance; mean_distance is that of all sources.
double source_weight(Weighting weighting, double distance, double mean_distance) {
    switch (weighting) {
        case Weighting::proportional:
            return distance;
        case Weighting::inverse:
            return 1.0 / (distance + 0.01 * mean_distance);
        case Weighting::gaussian:
            return std::exp(-distance * distance / (2.0 * mean_distance * mean_distance));
    }
    return 0;
}

}  // namespace

// ---------------------------------------------------------------- the frame

PartialFrame::PartialFrame(const MethodRequest& request, const Progress& progress)
    : PartialFrame(request, progress, variance_of(request.settings)) {}

PartialFrame::PartialFrame(const MethodRequest& request, const Progress& progress,
                           VarianceOf variance_of)
    : request_(request),
      progress_(progress),
      tracer_(request.scene, checked(request.settings), variance_of),
      frame_(make_frame(tracer_.size(), planes_to_keep(request.settings, variance_of))),
      state_(tracer_.size().area()) {
    require_memory(tracer_.size().area() * sizeof(FirstHitRecord),
                   "first hits of " + size_text(tracer_.size()));
    guide_.emplace(tracer_.centre_hits(stage(progress, 0, 0)), request.scene,
                   GuideSettings{tracer_.size(), request.parameters.min_normal_cosine,
                                 request.settings.threads});
}

void PartialFrame::store_traced(PixelTrace& pixel, const PixelValues& values) {
    store_values(values, pixel.at(), frame_);
    const bool finite = vecino::is_finite(values.radiance());
    if (!finite && state_[pixel.index()] != kNonFinite) pixel.mark_non_finite();
    state_[pixel.index()] = finite ? kFinite : kNonFinite;
}

void PartialFrame::trace(const PixelList& pixels, const ReaderOf& reader_of) {
    const auto trace_one = [&](PixelTrace& pixel) {
        pixel.trace({0, request_.settings.spp},
                    reader_of ? reader_of(pixel.index()) : BlockReader{});
        return pixel.values();
    };
    trace(pixels, trace_one,
          stage(progress_, share(traced_, area()), share(traced_ + pixels.size(), area())));
    traced_ += pixels.size();
}

void PartialFrame::trace_all(const std::function<void(PixelTrace&)>& body) {
    const auto trace_one = [&](PixelTrace& pixel) {
        body(pixel);
        store_traced(pixel, pixel.values());
    };
    tracer_.for_each_pixel(trace_one, progress_);
    traced_ = area();
    ++passes_;
}

void PartialFrame::trace(const PixelList& pixels,
                         const std::function<PixelValues(PixelTrace&)>& body,
                         const Progress& progress) {
    if (pixels.empty()) return;
    const auto trace_one = [&](PixelTrace& pixel) { store_traced(pixel, body(pixel)); };
    tracer_.for_each_pixel(pixels, trace_one, progress);
    ++passes_;
}

void PartialFrame::store(std::size_t pixel, const PixelValues& values) {
    store_values(values, pixel_at(pixel, size()), frame_);
}

void PartialFrame::store(std::size_t pixel, const Blend& blend) {
    store(pixel, blend.values(albedo_of(guide_->hit(pixel))));
}

void PartialFrame::filter(std::size_t pixel, const Blend& blend) {
    PixelValues values = blend.values(albedo_of(guide_->hit(pixel)));
    values.emission = frame_.emission.values()[pixel];
    values.samples = static_cast<std::uint64_t>(frame_.sample_count.values()[pixel]);
    store(pixel, values);
}

Blend PartialFrame::blend(const std::vector<Source>& sources, Weighting weighting) const {
    double mean_distance = 0;
    for (const Source& source : sources)
        mean_distance += source.distance / static_cast<double>(sources.size());
    Blend blend;
    for (const Source& source : sources) {
        blend.add(frame_, source.pixel, guide_->hit(source.pixel),
                  source_weight(weighting, source.distance, mean_distance));
    }
    return blend;
}

void PartialFrame::for_each(const PixelList& pixels,
                            const std::function<void(std::size_t)>& body) const {
    for_each_block(pixels.size(), kPixelsPerBlock, request_.settings.threads,
                   [&](BlockRange block) {
                       for (std::size_t i = block.begin; i < block.end; ++i) body(pixels[i]);
                   });
}

void PartialFrame::for_each(const std::function<void(std::size_t)>& body) const {
    for_each_block(area(), kPixelsPerBlock, request_.settings.threads, [&](BlockRange block) {
        for (std::size_t i = block.begin; i < block.end; ++i) body(i);
    });
}

SampleInterval PartialFrame::samples_of(std::size_t pixel) const {
    const int first = first_samples_(pixel_at(pixel, size()));
    const auto count = static_cast<int>(frame_.sample_count.values()[pixel]);
    return {first, first + (is_traced(pixel) ? std::max(count, 1) : request_.settings.spp)};
}

void PartialFrame::add_first_hits(Frame& frame) {
    const Planes asked = request_.settings.planes;
    const bool has_hits = common(asked, kFirstHitPlanes) != Planes{};
    const bool has_means = common(asked, kMeanPlanes) != Planes{};
    const bool at_centres = request_.settings.first_hit == FirstHit::centre;
    if (has_means || (has_hits && !at_centres)) {
        const auto all_of = [&](std::size_t pixel) { return samples_of(pixel); };
        const auto first_of = [&](std::size_t pixel) {
            const int first = samples_of(pixel).begin;
            return SampleInterval{first, first + 1};
        };
        const auto store = [&](std::size_t pixel, const FirstHitRecord& hit,
                               const GuideSums& sums) {
            const SampleInterval samples = samples_of(pixel);
            store_first_hit(hit, pixel_at(pixel, size()), frame);
            store_means(sums, samples.end - samples.begin, pixel_at(pixel, size()), frame);
        };
        tracer_.primary_hits(has_means ? SamplesOf(all_of) : SamplesOf(first_of), store,
                             stage(progress_, 1, 1));
    }
    for (std::size_t i = 0; at_centres && has_hits && i < area(); ++i)
        store_first_hit(guide_->hit(i), pixel_at(i, size()), frame);
}

MethodRender PartialFrame::finish(nlohmann::json facts) {
    add_first_hits(frame_);
    if (progress_ && !progress_(1.0)) throw Error(ExitCode::interrupted, "interrupted");
    const auto untraced = static_cast<std::size_t>(std::ranges::count(state_, kUntraced));
    const std::size_t traced = area() - untraced;
    const Planes asked = planes_to_make(request_.settings);
    for (const PlaneInfo& info : all_planes()) {
        if (asked.has(info.plane)) continue;
        std::visit([&](auto member) { frame_.*member = {}; }, info.member);
    }
    MethodRender result{.render = {std::move(frame_), tracer_.statistics()}};
    const RenderStatistics& s = result.render.statistics;
    facts["traced_share"] = share(traced, area());
    facts["interpolated_share"] = share(area() - traced, area());
    facts["passes"] = passes_;
    facts["mean_spp"] = share(s.samples, area());
    result.facts = std::move(facts);
    result.reconstruct_s = std::max(watch_.seconds() - s.scene_s - s.trace_s, 0.0);
    return result;
}

}  // namespace vecino
