/* See safestart_flight.h. Each bound on rounding stands where it is used, in units u = SS_UNIT of the precision. */
#include "safestart_flight.h"

#include <math.h>

#if defined(__clang__)
#pragma STDC FP_CONTRACT OFF
#endif

#define R(value) ((ss_real)(value))

static const ss_answer UNDECIDED = {SS_UNDECIDED, R(0)};

/* Shares of z that are drawn in at control points 1 to 5. */
static const ss_real STEP[SS_INNER] = {R(0), SS_FIFTH, R(0.5), SS_FOUR_FIFTHS, R(1)};

static ss_real size_of(ss_real value)
{
    return value < R(0) ? -value : value;
}

static ss_real smaller(ss_real one, ss_real other)
{
    return one < other ? one : other;
}

const ss_point *ss_point_of(int i)
{
    return i >= 0 && i < SS_POINTS ? &ss_points[i] : (const ss_point *)0;
}

/* Least distance to the first so many faces. */
static ss_real room(const ss_point *point, int faces, ss_real x, ss_real y, ss_real z)
{
    ss_real least = SS_FAR;
    for (int i = 0; i < faces; i++) { /* at most SS_FACES */
        const ss_real *face = point->face[i];
        least = smaller(least, face[0] - (face[1] * x + face[2] * y + face[3] * z));
    }
    return least;
}

/* beta, the distance to the stop over the range, from below (e > 0) or above (e < 0); a square may be off by |e|. */
static ss_real stopping(const ss_point *point, ss_real rho, ss_real e)
{
    const ss_real spare = R(1) - point->lost * rho, pull = point->across * rho;
    const ss_real square = spare * spare - pull * pull + e;
    ss_real rest = square - R(2) * point->turning * point->speed_squared * (rho * rho) + e;
    if (!(square > R(0))) {
        return SS_FAR;
    }
    rest = rest > R(0) ? rest : R(0);
    return point->speed_squared * rho / (ss_sqrt(square) + ss_sqrt(rest));
}

/* Least distance at the stop; it is affine in beta, so least at an end of its interval. */
static ss_real braked(
    const ss_point *point, int faces, ss_real x, ss_real y, ss_real z, ss_real low, ss_real high)
{
    const ss_real e = R(64) * SS_UNIT, wide = R(16) * SS_UNIT;
    const ss_real least = stopping(point, low, e) * (R(1) - wide);
    const ss_real most = stopping(point, high, -e) * (R(1) + wide);
    if (!(most < R(2))) {
        return -SS_FAR;
    }
    return smaller(
        room(point, faces, x + least * y, y - least * x, z), room(point, faces, x + most * y, y - most * x, z));
}

/* Least distance over the control points of one member. */
static ss_real turned(const ss_point *point, int faces, int k, ss_real x, ss_real y, ss_real z, ss_real drop)
{
    ss_real least = SS_FAR;
    for (int j = 0; j < SS_INNER; j++) { /* SS_INNER */
        const ss_real *h = point->inner[k][j];
        least = smaller(least, room(point, faces, x * h[0] - y * h[1], x * h[1] + y * h[0], z - z * drop * STEP[j]));
    }
    return least;
}

/* The first member whose reach is at least rho, SS_MEMBERS where there is none. */
static int member_of(const ss_point *point, ss_real rho)
{
    int k = 0;
    for (int step = SS_MEMBERS_POWER; step > 0; step /= 2) { /* SS_MEMBERS_POWER is a power of two: its logarithm + 1 */
        if (k + step <= SS_MEMBERS && point->reach[k + step - 1] < rho) {
            k += step;
        }
    }
    return k;
}

/* Least distance over every member that rounding lets rho mean. */
static ss_real turning_in(
    const ss_point *point, int faces, ss_real x, ss_real y, ss_real z, ss_real low, ss_real high, int draw)
{
    const int first = member_of(point, low), last = member_of(point, high);
    ss_real least = SS_FAR;
    if (last >= SS_MEMBERS) {
        return -SS_FAR;
    }
    for (int k = first; k <= last; k++) { /* at most SS_MEMBERS; one or two in practice */
        least = smaller(least, turned(point, faces, k, x, y, z, draw ? point->drop[k] : R(0)));
    }
    return least;
}

static ss_answer certified(const ss_point *point, int faces, ss_real x, ss_real y, ss_real z)
{
    const ss_real wide = R(16) * SS_UNIT;
    const ss_real far = size_of(x) + size_of(y) + size_of(z);
    ss_answer answer = UNDECIDED;
    if (!point || !(far <= SS_FARTHEST)) { /* a NaN, too */
        return answer;
    }
    /* 24 u times the spread of a member and the largest term covers every distance below, here and in safestart. */
    const ss_real slack = R(32) * SS_UNIT * point->spread * (point->widest + far);
    const ss_real here = room(point, faces, x, y, z);
    if (here + slack < -R(2) * SS_ROUNDING) {
        answer.verdict = SS_NO_GO;
        answer.margin = here + slack;
        return answer;
    }
    const ss_real start = here - slack;
    if (!(start > SS_ROUNDING)) {
        return answer;
    }
    const ss_real square = x * x + y * y, radius = ss_sqrt(square) * point->scale;
    const ss_real sway = size_of(z) * point->sway;
    const ss_real more = sway * (R(1) + wide), less = sway * (R(1) - wide);
    const ss_real left = R(1) - more * more - wide, right = R(1) - less * less + wide;
    ss_real best = -SS_FAR;
    if (left > R(0)) {
        const ss_real low = radius / ss_sqrt(right) * (R(1) - wide), high = radius / ss_sqrt(left) * (R(1) + wide);
        if (!point->turns) {
            const ss_real pull = R(3) * size_of(x) * point->sway;
            if ((pull * pull + sway * sway) * (R(1) + wide) <= R(1)) {
                best = start;
            }
        } else if (high <= point->brake_limit) {
            best = braked(point, faces, x, y, z, low, high) - slack;
        }
        const ss_real held = turning_in(point, faces, x, y, z, low, high, 0) - slack;
        best = held > best ? held : best;
        if (faces > SS_PLANAR && (z > R(0) || z < R(0)) && more < R(1)) {
            const ss_real range = ss_sqrt(square + z * z) * point->scale;
            const ss_real near = range / (R(1) - less + wide) * (R(1) - wide);
            const ss_real away = R(1) - more - wide;
            if (away > R(0)) {
                const ss_real drawn =
                    turning_in(point, faces, x, y, z, near, range / away * (R(1) + wide), 1) - slack;
                best = drawn > best ? drawn : best;
            }
        }
    }
    best = smaller(best, start);
    if (best > SS_ROUNDING) {
        answer.verdict = SS_GO;
        answer.margin = (best - SS_ROUNDING) * (R(1) - R(4) * SS_UNIT);
    }
    return answer;
}

ss_answer ss_certify(const ss_point *point, ss_real x, ss_real y)
{
    return certified(point, SS_PLANAR, x, y, R(0));
}

ss_answer ss_certify_in_space(const ss_point *point, ss_real x, ss_real y, ss_real z)
{
    return certified(point, SS_FACES, x, y, z);
}

ss_answer ss_atlas(const ss_point *point, ss_real x, ss_real y)
{
    const ss_real far = size_of(x) + size_of(y);
    ss_answer answer = UNDECIDED;
    if (!point || !(far <= SS_FARTHEST)) {
        return answer;
    }
    if (y <= point->y_max) {
        for (int i = 0; i < point->ceilings; i++) { /* at most SS_CEILINGS */
            const ss_real *c = point->ceiling[i];
            const ss_real across = c[0] * x, along = c[1] * y;
            /* 4 u of the terms here, the same again in safestart. */
            const ss_real most =
                across + along + c[2] + R(8) * SS_UNIT * (size_of(across) + size_of(along) + size_of(c[2]));
            if (most < -SS_GUARD && most < answer.margin) {
                answer.verdict = SS_NO_GO;
                answer.margin = most;
            }
        }
        if (answer.verdict == SS_NO_GO) {
            return answer;
        }
    }
    const ss_real dx = x - point->centre[0], dy = y - point->centre[1];
    const ss_real ox = size_of(point->centre[0]) + size_of(dx), oy = size_of(point->centre[1]) + size_of(dy);
    for (int j = 0; j < point->rim; j++) { /* at most SS_RIM */
        const ss_sector *s = &point->sector[j];
        const ss_real one = (dx * s->b[1] - dy * s->b[0]) * s->inverse;
        const ss_real two = (s->a[0] * dy - s->a[1] * dx) * s->inverse;
        /* 5 u of the products' sizes, 1 u of the centre's, 2 u of the quotient; twice that for safestart. */
        const ss_real e = R(16) * SS_UNIT * s->inverse;
        const ss_real first = one - e * (ox * size_of(s->b[1]) + oy * size_of(s->b[0]));
        const ss_real second = two - e * (ox * size_of(s->a[1]) + oy * size_of(s->a[0]));
        const ss_real rest = R(1) - (one + (one - first)) - (two + (two - second)) - R(8) * SS_UNIT;
        if (first > s->least && second > s->least && rest > s->least) {
            const ss_real margin =
                (rest * point->centre_margin + first * s->margin[0] + second * s->margin[1]) * (R(1) - R(8) * SS_UNIT);
            if (margin > SS_GUARD) {
                answer.verdict = SS_GO;
                answer.margin = margin;
                return answer;
            }
        }
    }
    return answer;
}

ss_answer ss_may_start(const ss_point *point, ss_real x, ss_real y)
{
    const ss_answer answer = ss_certify(point, x, y);
    return answer.verdict == SS_GO ? answer : ss_atlas(point, x, y);
}

/* The flight between two samples: position and velocity in LVLH, and bounds on what rounding has made of them. */
typedef struct {
    ss_real x[4];
    ss_real off, drift; /* m, m/s */
} ss_state;

static ss_real length(ss_real x, ss_real y)
{
    return ss_sqrt(x * x + y * y);
}

static ss_state moved(const ss_point *point, const ss_state *from, const ss_real u[2])
{
    const ss_real h = point->h, wide = R(32) * SS_UNIT;
    const ss_real fast = size_of(from->x[2]) + size_of(from->x[3]) + h * (size_of(u[0]) + size_of(u[1]));
    const ss_real far = size_of(from->x[0]) + size_of(from->x[1]) + h * fast;
    ss_state to;
    for (int i = 0; i < 4; i++) { /* 4 */
        const ss_real *row = point->drift[i];
        to.x[i] = row[0] * from->x[0] + row[1] * from->x[1] + row[2] * from->x[2] + row[3] * from->x[3]
            + (point->push[i][0] * u[0] + point->push[i][1] * u[1]);
    }
    /* Six products and the table's own rounding, 16 u of their sizes; errors grow as states do, by less than 1 + 4 n h. */
    to.off = (from->off + h * from->drift) * point->growth + wide * far;
    to.drift = (from->drift + point->pull * from->off) * point->growth + wide * (fast + point->pull * far);
    return to;
}

/* Distance to a face and its rate, 1/s, after the corridor has turned by `turn` (cosine, sine). */
static void seen(
    const ss_point *point, const ss_real face[4], const ss_real turn[2], const ss_state *at, ss_real value[2])
{
    const ss_real w = point->omega_rad_s;
    const ss_real nx = turn[0] * face[1] - turn[1] * face[2], ny = turn[1] * face[1] + turn[0] * face[2];
    value[0] = face[0] - (nx * at->x[0] + ny * at->x[1]);
    value[1] = -(nx * (at->x[2] + w * at->x[1]) + ny * (at->x[3] - w * at->x[0]));
}

/* A bound on how far a distance may lie below the cubic through both ends: h^4 / 384 times its fourth derivative. */
static ss_real bend(const ss_point *point, const ss_state *a, const ss_state *b, ss_real push)
{
    const ss_real w = point->omega_rad_s, n = point->mean_motion_rad_s, half = R(0.5) * point->h, h2 = point->h * point->h;
    const ss_real ra = length(a->x[0], a->x[1]) + a->off, rb = length(b->x[0], b->x[1]) + b->off;
    const ss_real va = length(a->x[2], a->x[3]) + a->drift, vb = length(b->x[2], b->x[3]) + b->drift;
    const ss_real r0 = ra > rb ? ra : rb, v0 = va > vb ? va : vb;
    const ss_real gain = half * (R(2) * n + R(3) * n * n * half); /* below 1e-2: n h is small */
    const ss_real v = (v0 + half * (R(3) * n * n * r0 + push)) / (R(1) - gain), r = r0 + half * v;
    const ss_real acc = R(3) * n * n * r + R(2) * n * v + push, jerk = R(3) * n * n * v + R(2) * n * acc;
    const ss_real snap = R(3) * n * n * acc + R(2) * n * jerk, w2 = w * w;
    const ss_real fourth = w2 * w2 * r + R(4) * w2 * w * v + R(6) * w2 * acc + R(4) * w * jerk + snap;
    return fourth * (h2 * h2) / R(384) * (R(1) + R(64) * SS_UNIT);
}

ss_answer ss_check_thrust(const ss_point *point, ss_real x, ss_real y, const ss_real thrust[2 * SS_STEPS])
{
    if (!point || !thrust) {
        return UNDECIDED;
    }
    const ss_real most = point->a_max_m_s2 * point->a_max_m_s2 * (R(1) - R(8) * SS_UNIT);
    const ss_real w = point->omega_rad_s, h = point->h, third = h / R(3);
    ss_state here = {{x, y, R(0), R(0)}, R(0), R(0)};
    ss_real least = SS_FAR;
    ss_answer answer = UNDECIDED;
    if (!(size_of(x) + size_of(y) <= SS_FARTHEST)) {
        return answer;
    }
    for (int k = 0; k < SS_STEPS; k++) { /* SS_STEPS */
        const ss_real *u = &thrust[2 * k];
        if (!(u[0] * u[0] + u[1] * u[1] <= most)) {
            return answer;
        }
        const ss_real push = length(u[0], u[1]) * (R(1) + R(4) * SS_UNIT);
        for (int s = 0; s < point->samples; s++) { /* at most SS_SAMPLES */
            const int at = k * point->samples + s;
            const ss_state next = moved(point, &here, u);
            const ss_real far = size_of(next.x[0]) + size_of(next.x[1]) + size_of(here.x[0]) + size_of(here.x[1]);
            const ss_real fast = size_of(next.x[2]) + size_of(next.x[3]) + size_of(here.x[2]) + size_of(here.x[3]);
            /* Of a distance and of h / 3 times its rate: what the state is off, and 12 u of every term. */
            const ss_real off = here.off > next.off ? here.off : next.off;
            const ss_real drift = here.drift > next.drift ? here.drift : next.drift;
            const ss_real lost = R(1.5) * (off + third * (drift + w * off))
                + R(24) * SS_UNIT * (point->widest + far + third * (fast + w * far)) + bend(point, &here, &next, push);
            for (int i = 0; i < SS_PLANAR; i++) { /* SS_PLANAR */
                ss_real before[2], after[2];
                seen(point, point->face[i], point->turn[at], &here, before);
                seen(point, point->face[i], point->turn[at + 1], &next, after);
                /* The cubic's Bernstein coefficients bound it from below. */
                const ss_real ends = smaller(before[0], after[0]);
                const ss_real inner = smaller(before[0] + third * before[1], after[0] - third * after[1]);
                least = smaller(least, smaller(ends, inner) - lost);
            }
            here = next;
        }
    }
    if (least > SS_GUARD) {
        answer.verdict = SS_GO;
        answer.margin = least;
    }
    return answer;
}
