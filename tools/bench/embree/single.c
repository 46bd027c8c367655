/* Embree's side of tools/bench/embree/run: one ray at a time through the triangles of a file.
 *
 * usage: single LIBRARY FOLDER QUALITY    (quality 1: Embree's default, 2: high)
 *
 * Speaks as the example "rays" of crates/trace does: says "ready" with the library's version, then for each line of
 * standard input "time NAME" the seconds of processor time and the count of a set of rays, for "answers NAME FILE" the
 * hits. The library is opened by name, and what is needed of its interface declared here, so that neither headers nor
 * a certain version (3 or 4) have to be installed.
 */
#include <dlfcn.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/types.h>
#include <time.h>
#if defined(__SSE__)
#include <xmmintrin.h>
#endif

/* Public interface of Embree: the ray, the hit, and both; other versions only add fields at the end. */
typedef struct {
	float org[3], tnear, dir[3], time, tfar;
	unsigned mask, id, flags;
} Ray;

typedef struct {
	Ray ray;
	float ng[3], u, v;
	unsigned prim, geom, instance[4];
	char rest[64];
} __attribute__((aligned(16))) RayHit;

enum { TRIANGLES = 0, INDEX = 0, VERTEX = 1, UINT3 = 0x5003, FLOAT3 = 0x9003, VERSION = 0 };

static void *library;

static void *find(const char *name)
{
	void *f = dlsym(library, name);
	if (!f) {
		fprintf(stderr, "single: the library has no %s\n", name);
		exit(1);
	}
	return f;
}

/* A whole file; its size goes to *size. */
static void *load(const char *folder, const char *name, const char *ending, size_t *size)
{
	char path[4096];
	snprintf(path, sizeof path, "%s/%s%s", folder, name, ending);
	FILE *f = fopen(path, "rb");
	if (!f || fseek(f, 0, SEEK_END) != 0) {
		fprintf(stderr, "single: %s cannot be read\n", path);
		exit(1);
	}
	*size = (size_t)ftell(f);
	rewind(f);
	/* Embree reads up to 16 bytes beyond a buffer. */
	void *data = malloc(*size + 16);
	if (!data || fread(data, 1, *size, f) != *size) {
		fprintf(stderr, "single: %s cannot be read\n", path);
		exit(1);
	}
	fclose(f);
	return data;
}

/* Origin, direction, limit. */
typedef struct {
	float v[7];
} Given;

typedef struct {
	char name[64];
	Given *rays;
	size_t count;
	int nearest;
} Set;

static void *scene;
static int version;
static void (*one3)(void *, void *, void *), (*one4)(void *, void *, void *);
static void (*shadow3)(void *, void *, void *), (*shadow4)(void *, void *, void *);
/* Version 3 takes a context: flags, filter, instances; none of them used. */
static struct {
	int flags;
	void *filter;
	unsigned instance[8];
} context = {0, 0, {~0u, ~0u, ~0u, ~0u, ~0u, ~0u, ~0u, ~0u}};

static inline void fill(Ray *r, const Given *g)
{
	memcpy(r->org, g->v, 12);
	memcpy(r->dir, g->v + 3, 12);
	r->tnear = 0;
	r->tfar = g->v[6];
	r->time = 0;
	r->mask = ~0u;
	r->id = r->flags = 0;
}

static inline void nearest(RayHit *h, const Given *g)
{
	fill(&h->ray, g);
	h->geom = h->prim = h->instance[0] = ~0u;
	if (version < 4)
		one3(scene, &context, h);
	else
		one4(scene, h, 0);
}

static inline int reaches(RayHit *h, const Given *g)
{
	fill(&h->ray, g);
	if (version < 4)
		shadow3(scene, &context, &h->ray);
	else
		shadow4(scene, &h->ray, 0);
	return h->ray.tfar >= 0;
}

static void measure(const Set *set)
{
	static RayHit h;
	struct timespec a, b;
	size_t yes = 0;
	clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &a);
	if (set->nearest) {
		for (size_t i = 0; i < set->count; i++) {
			nearest(&h, set->rays + i);
			yes += h.geom != ~0u;
		}
	} else {
		for (size_t i = 0; i < set->count; i++)
			yes += (size_t)reaches(&h, set->rays + i);
	}
	clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &b);
	printf("%.9f %zu\n", (double)(b.tv_sec - a.tv_sec) + 1e-9 * (double)(b.tv_nsec - a.tv_nsec), yes);
}

static void answers(const Set *set, const char *path)
{
	static RayHit h;
	FILE *f = fopen(path, "wb");
	if (!f)
		exit(1);
	for (size_t i = 0; i < set->count; i++) {
		uint32_t what;
		double distance = 0;
		if (set->nearest) {
			nearest(&h, set->rays + i);
			what = h.prim;
			if (h.geom != ~0u)
				distance = h.ray.tfar;
		} else {
			what = !reaches(&h, set->rays + i);
		}
		fwrite(&what, 4, 1, f);
		fwrite(&distance, 8, 1, f);
	}
	fclose(f);
	puts("written");
}

static void *commit(const char *folder, int quality)
{
	void *(*new_device)(const char *) = find("rtcNewDevice");
	ssize_t (*property)(void *, int) = find("rtcGetDeviceProperty");
	void *(*new_scene)(void *) = find("rtcNewScene");
	void (*set_quality)(void *, int) = find("rtcSetSceneBuildQuality");
	void *(*new_geometry)(void *, int) = find("rtcNewGeometry");
	void (*buffer)(void *, int, unsigned, int, const void *, size_t, size_t, size_t) = find("rtcSetSharedGeometryBuffer");
	void (*commit_geometry)(void *) = find("rtcCommitGeometry");
	unsigned (*attach)(void *, void *) = find("rtcAttachGeometry");
	void (*commit_scene)(void *) = find("rtcCommitScene");

	void *device = new_device(0);
	if (!device)
		exit(1);
	version = (int)property(device, VERSION);
	size_t size;
	float *vertices = load(folder, "triangles", "", &size);
	size_t count = size / 36;
	uint32_t *index = malloc(count * 12 + 16);
	for (size_t i = 0; i < count * 3; i++)
		index[i] = (uint32_t)i;
	void *s = new_scene(device), *g = new_geometry(device, TRIANGLES);
	set_quality(s, quality);
	buffer(g, VERTEX, 0, FLOAT3, vertices, 0, 12, count * 3);
	buffer(g, INDEX, 0, UINT3, index, 0, 12, count);
	commit_geometry(g);
	attach(s, g);
	commit_scene(s);
	printf("ready %d.%d.%d\n", version / 10000, version / 100 % 100, version % 100);
	version /= 10000;
	return s;
}

int main(int argc, char **argv)
{
	static Set sets[16];
	int known = 0;
	char line[4096];
	if (argc != 4) {
		fprintf(stderr, "usage: single LIBRARY FOLDER QUALITY\n");
		return 2;
	}
	library = dlopen(argv[1], RTLD_NOW);
	if (!library) {
		fprintf(stderr, "single: %s\n", dlerror());
		return 1;
	}
#if defined(__SSE__)
	/* As Embree's manual asks: denormal numbers are 0. */
	_mm_setcsr(_mm_getcsr() | 0x8040);
#endif
	setvbuf(stdout, 0, _IOLBF, 0);
	scene = commit(argv[2], atoi(argv[3]));
	one3 = one4 = find("rtcIntersect1");
	shadow3 = shadow4 = find("rtcOccluded1");
	while (fgets(line, sizeof line, stdin)) {
		char what[16], name[64], file[4000] = "";
		if (sscanf(line, "%15s %63s %3999s", what, name, file) < 2)
			continue;
		Set *set = sets;
		while (set < sets + known && strcmp(set->name, name))
			set++;
		if (set == sets + known) {
			size_t size;
			double *given = load(argv[2], name, ".rays", &size);
			known++;
			strcpy(set->name, name);
			set->count = size / 56;
			set->rays = malloc(set->count * sizeof *set->rays);
			for (size_t i = 0; i < set->count * 7; i++)
				set->rays[i / 7].v[i % 7] = (float)given[i];
			free(given);
			set->nearest = strncmp(name, "lamp", 4) && strcmp(name, "open");
		}
		if (what[0] == 't')
			measure(set);
		else
			answers(set, file);
	}
	return 0;
}
