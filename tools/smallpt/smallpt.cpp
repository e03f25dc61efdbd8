// The 99-line path tracer smallpt (Kevin Beason 2008, www.kevinbeason.com/smallpt), told anew: the yardstick of
// tools/chart.py and of the scene scenes/smallpt.toml.
//
//     g++ -O3 -march=native -o smallpt tools/smallpt.cpp
//     ./smallpt SAMPLES WIDTH HEIGHT SEED OUT.pfm [--box] [--no-clamp] [--exact-fresnel] [--offset LENGTH]
//
// SAMPLES (per pixel) is a multiple of 4. The image is linear, before gamma. Without flags and with seed 0 it is the
// original's as g++ compiles it, in every pixel to single precision: the language leaves open whether the original's
// rays start 140 from the eye or on a plane 140 away, and which way out of the glass is followed first; g++ takes the
// distance, and the refracted ray. Each flag drops one habit of the original:
//     --box            spreads samples uniformly over the four quarters of a pixel, in place of a tent over each
//     --no-clamp       keeps what a quarter of a pixel shows above 1
//     --exact-fresnel  weighs the glass ball by Fresnel's equations in place of Schlick's approximation
//     --offset LENGTH  forgets hits nearer than LENGTH in place of 1e-4

#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <vector>

struct Options {
    bool box = false;
    bool clamp = true;
    bool exact_fresnel = false;
    double offset = 1e-4;
} options;

struct Vector {
    double x, y, z;
    Vector operator+(const Vector &v) const { return {x + v.x, y + v.y, z + v.z}; }
    Vector operator-(const Vector &v) const { return {x - v.x, y - v.y, z - v.z}; }
    Vector operator*(double factor) const { return {x * factor, y * factor, z * factor}; }
    Vector operator*(const Vector &v) const { return {x * v.x, y * v.y, z * v.z}; }
};

double dot(const Vector &a, const Vector &b) { return a.x * b.x + a.y * b.y + a.z * b.z; }

Vector cross(const Vector &a, const Vector &b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

Vector unit(const Vector &v) { return v * (1 / std::sqrt(dot(v, v))); }

struct Random {
    unsigned short state[3];
    double next() { return erand48(state); }
};

struct Ray {
    Vector origin, direction;
};

enum class Material { diffuse, mirror, glass };

struct Sphere {
    double radius;
    Vector center, emission, color;
    Material material;

    // The distance to the first crossing beyond the offset, 0 where there is none.
    double hit(const Ray &ray) const {
        const Vector to_center = center - ray.origin;
        const double middle = dot(to_center, ray.direction);
        const double squared = middle * middle - dot(to_center, to_center) + radius * radius;
        if (squared < 0) return 0;
        const double half = std::sqrt(squared);
        if (middle - half > options.offset) return middle - half;
        return middle + half > options.offset ? middle + half : 0;
    }
};

const Sphere spheres[] = {
    {1e5, {1e5 + 1, 40.8, 81.6}, {0, 0, 0}, {.75, .25, .25}, Material::diffuse},
    {1e5, {-1e5 + 99, 40.8, 81.6}, {0, 0, 0}, {.25, .25, .75}, Material::diffuse},
    {1e5, {50, 40.8, 1e5}, {0, 0, 0}, {.75, .75, .75}, Material::diffuse},
    {1e5, {50, 40.8, -1e5 + 170}, {0, 0, 0}, {0, 0, 0}, Material::diffuse},
    {1e5, {50, 1e5, 81.6}, {0, 0, 0}, {.75, .75, .75}, Material::diffuse},
    {1e5, {50, -1e5 + 81.6, 81.6}, {0, 0, 0}, {.75, .75, .75}, Material::diffuse},
    {16.5, {27, 16.5, 47}, {0, 0, 0}, {.999, .999, .999}, Material::mirror},
    {16.5, {73, 16.5, 78}, {0, 0, 0}, {.999, .999, .999}, Material::glass},
    {600, {50, 681.6 - .27, 81.6}, {12, 12, 12}, {0, 0, 0}, Material::diffuse},
};

const Sphere *nearest(const Ray &ray, double &distance) {
    const Sphere *found = nullptr;
    distance = 1e20;
    for (int i = sizeof(spheres) / sizeof(Sphere); i--;) {
        const double candidate = spheres[i].hit(ray);
        if (candidate && candidate < distance) {
            distance = candidate;
            found = &spheres[i];
        }
    }
    return found;
}

// A direction about the normal with density cosine / pi.
Vector cosine_direction(const Vector &normal, Random &random) {
    const double turn = 2 * M_PI * random.next(), share = random.next(), radius = std::sqrt(share);
    const Vector axis = std::fabs(normal.x) > .1 ? Vector{0, 1, 0} : Vector{1, 0, 0};
    const Vector u = unit(cross(axis, normal)), v = cross(normal, u);
    return unit(u * std::cos(turn) * radius + v * std::sin(turn) * radius + normal * std::sqrt(1 - share));
}

// The reflectance of unpolarized light: Fresnel's equations, or Schlick 1994, equation 15, about the cosine in air.
double fresnel(double cos_i, double cos_t, double n_i, double n_t) {
    if (options.exact_fresnel) {
        const double s = (n_i * cos_i - n_t * cos_t) / (n_i * cos_i + n_t * cos_t);
        const double p = (n_t * cos_i - n_i * cos_t) / (n_t * cos_i + n_i * cos_t);
        return (s * s + p * p) / 2;
    }
    const double normal = (n_t - n_i) * (n_t - n_i) / ((n_t + n_i) * (n_t + n_i));
    const double c = 1 - (n_i < n_t ? cos_i : cos_t);
    return normal + (1 - normal) * c * c * c * c * c;
}

Vector radiance(const Ray &ray, int depth, Random &random);

// What reaches the eye through the glass: both ways at the first two bounces, then one of them by chance.
Vector through_glass(const Ray &ray, const Ray &reflected, const Vector &normal, const Vector &facing, int depth,
                     Random &random) {
    const bool into = dot(normal, facing) > 0;
    const double n_i = into ? 1 : 1.5, n_t = into ? 1.5 : 1, ratio = n_i / n_t;
    const double cos_i = -dot(ray.direction, facing);
    const double squared = 1 - ratio * ratio * (1 - cos_i * cos_i);
    if (squared < 0) return radiance(reflected, depth, random);
    const double cos_t = std::sqrt(squared);
    const Ray refracted{reflected.origin, unit(ray.direction * ratio + facing * (ratio * cos_i - cos_t))};
    const double reflectance = fresnel(cos_i, cos_t, n_i, n_t);
    if (depth <= 2) {
        const Vector behind = radiance(refracted, depth, random) * (1 - reflectance);
        return radiance(reflected, depth, random) * reflectance + behind;
    }
    const double chance = .25 + .5 * reflectance;
    if (random.next() < chance) return radiance(reflected, depth, random) * (reflectance / chance);
    return radiance(refracted, depth, random) * ((1 - reflectance) / (1 - chance));
}

Vector radiance(const Ray &ray, int depth, Random &random) {
    double distance;
    const Sphere *const sphere = nearest(ray, distance);
    if (!sphere) return {0, 0, 0};
    const Vector point = ray.origin + ray.direction * distance;
    const Vector normal = unit(point - sphere->center);
    const Vector facing = dot(normal, ray.direction) < 0 ? normal : normal * -1;
    Vector color = sphere->color;
    if (++depth > 5) {
        const double survival = std::fmax(color.x, std::fmax(color.y, color.z));
        if (random.next() >= survival) return sphere->emission;
        color = color * (1 / survival);
    }
    if (sphere->material == Material::diffuse)
        return sphere->emission + color * radiance({point, cosine_direction(facing, random)}, depth, random);
    const Ray reflected{point, ray.direction - normal * 2 * dot(normal, ray.direction)};
    if (sphere->material == Material::mirror)
        return sphere->emission + color * radiance(reflected, depth, random);
    return sphere->emission + color * through_glass(ray, reflected, normal, facing, depth, random);
}

// Where in (-1, 1), or (-1/2, 1/2) for the box, a sample falls about the middle of its quarter pixel.
double jitter(Random &random) {
    if (options.box) return random.next() - .5;
    const double r = 2 * random.next();
    return r < 1 ? std::sqrt(r) - 1 : 1 - std::sqrt(2 - r);
}

double clamp(double value) { return options.clamp ? std::fmin(std::fmax(value, 0), 1) : value; }

// Row y counts from the bottom, as rows of a PFM do.
void render_row(int y, int width, int height, int samples, uint32_t seed, float *row) {
    const Vector eye{50, 52, 295.6}, forward = unit({0, -0.042612, -1});
    const Vector across{width * .5135 / height, 0, 0}, up = unit(cross(across, forward)) * .5135;
    Random random{{uint16_t(seed), uint16_t(seed >> 16), uint16_t(uint32_t(y) * y * y)}};
    for (int x = 0; x < width; x++) {
        Vector pixel{0, 0, 0};
        for (int quarter = 0; quarter < 4; quarter++) {
            Vector mean{0, 0, 0};
            for (int sample = 0; sample < samples / 4; sample++) {
                const double dx = jitter(random), dy = jitter(random);
                const Vector d = unit(across * (((quarter % 2 + .5 + dx) / 2 + x) / width - .5) +
                                      up * (((quarter / 2 + .5 + dy) / 2 + y) / height - .5) + forward);
                // Rays start 140 on: the eye stands outside the front wall.
                mean = mean + radiance({eye + d * 140, d}, 0, random) * (4. / samples);
            }
            pixel = pixel + Vector{clamp(mean.x), clamp(mean.y), clamp(mean.z)} * .25;
        }
        for (double value : {pixel.x, pixel.y, pixel.z}) *row++ = float(value);
    }
}

// Spreads consecutive seeds over all bits (the finalizer of MurmurHash3, Appleby 2011); 0 stays 0.
uint32_t mix(uint32_t seed) {
    seed = (seed ^ (seed >> 16)) * 0x85ebca6b;
    seed = (seed ^ (seed >> 13)) * 0xc2b2ae35;
    return seed ^ (seed >> 16);
}

bool read_flags(int count, char **words) {
    for (int i = 0; i < count; i++) {
        if (!std::strcmp(words[i], "--box")) options.box = true;
        else if (!std::strcmp(words[i], "--no-clamp")) options.clamp = false;
        else if (!std::strcmp(words[i], "--exact-fresnel")) options.exact_fresnel = true;
        else if (!std::strcmp(words[i], "--offset") && i + 1 < count) options.offset = std::atof(words[++i]);
        else return false;
    }
    return true;
}

int main(int count, char **words) {
    const int samples = count > 5 ? std::atoi(words[1]) : 0;
    const int width = samples ? std::atoi(words[2]) : 0, height = samples ? std::atoi(words[3]) : 0;
    if (samples < 4 || samples % 4 || width < 1 || height < 1 || !read_flags(count - 6, words + 6)) {
        std::fprintf(stderr, "smallpt SAMPLES WIDTH HEIGHT SEED OUT.pfm"
                             " [--box] [--no-clamp] [--exact-fresnel] [--offset LENGTH]\n"
                             "SAMPLES is a multiple of 4\n");
        return 2;
    }
    const uint32_t seed = mix(uint32_t(std::strtoul(words[4], nullptr, 10)));
    std::vector<float> image(size_t(width) * height * 3);
    for (int y = 0; y < height; y++) render_row(y, width, height, samples, seed, &image[size_t(y) * width * 3]);
    FILE *const file = std::fopen(words[5], "wb");
    if (!file) return std::perror(words[5]), 1;
    std::fprintf(file, "PF\n%d %d\n-1.0\n", width, height);
    const bool written = std::fwrite(image.data(), sizeof(float), image.size(), file) == image.size();
    if (std::fclose(file) || !written) return std::perror(words[5]), 1;
}
