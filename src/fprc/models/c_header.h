/* $generated
 * $model as C99 or C++, without memory allocation.$origin
 *
 * $equation
 *
 * Inputs of each sample, $rate:
$inputs
 * Output: P_ff, $unit
 *
 * Use:  pff_state state;
 *       pff_init(&state);
 *       at each sample:  $use
 *
 * Compile without -ffast-math, -Ofast and -ffinite-math-only: they take out the check for NaN. */
#ifndef PFF_H
#define PFF_H

#if defined(__FAST_MATH__) || defined(_M_FP_FAST) \
    || (defined(__FINITE_MATH_ONLY__) && __FINITE_MATH_ONLY__)
#error "NaN would give a plausible P_ff: compile without -ffast-math and -ffinite-math-only"
#endif

#include <math.h>

$sizes

/* Define PFF_FLOAT, by the command of the compiler or above, to compute with float. A model that
 * learns does not: its covariance would lose its sign. */
#ifndef PFF_FLOAT
typedef double pff_real;
#define PFF_EXP exp
#elif defined(PFF_LEARNS)
#error "a model that learns computes with double only"
#else
typedef float pff_real;
#define PFF_EXP expf
#endif

/* Of each feature: its column of x, its kind, and the number of that kind, see pff_step. Of each
 * rule: its centre, weights, and output at the centre, kPa. Of a model that learns: its settings,
 * and the covariance of its weights after the training. */
$tables

#ifdef PFF_LEARNS
#define PFF_NONE ((unsigned long)-1)
#endif

/* One stream of samples. */
typedef struct {
    pff_real row[PFF_ROW]; /* features, the latest tap of each input first */
    int streaming; /* 0 until the first sample */
#ifdef PFF_LEARNS
    pff_real learned[PFF_WEIGHTS], covariance[PFF_WEIGHTS][PFF_WEIGHTS]; /* of the readout */
    pff_real phi[PFF_DELAY][PFF_WEIGHTS], base[PFF_DELAY]; /* of the last samples, as the next */
    pff_real p_ff[PFF_DELAY], p_fb[PFF_DELAY];
    pff_real believed; /* the last angle that can be true, deg */
    unsigned long k, doubted; /* samples of the stream, and since that angle; before any, PFF_NONE */
#endif
} pff_state;

/* Return whether x is a number that a sample may be; NaN is not. */
static inline int pff_is_number(pff_real x)
{
    return x >= -pff_largest && x <= pff_largest;
}

/* Begin a new stream at the next sample, which is the assumed input at all earlier times. */
static inline void pff_init(pff_state *state)
{
#ifdef PFF_LEARNS
    int i, j;

    for (i = 0; i < PFF_WEIGHTS; i++) {
        state->learned[i] = 0;
        for (j = 0; j < PFF_WEIGHTS; j++) {
            state->covariance[i][j] = pff_prior[i][j];
        }
    }
    state->k = 0;
    state->believed = 0;
    state->doubted = PFF_NONE;
#endif
    state->streaming = 0;
}

/* Begin a new stream; x is the assumed input at all earlier times. If x holds NaN, infinity or a
 * number beyond 1e9, the stream begins at the next sample instead. */
static inline void pff_reset(pff_state *state, const pff_real x[PFF_INPUTS])
{
    int i;

    pff_init(state);
    state->streaming = 1;
    for (i = 0; i < PFF_INPUTS; i++) {
        state->streaming = state->streaming && pff_is_number(x[i]);
    }
    for (i = 0; i < PFF_ROW; i++) {
        state->row[i] = x[pff_column[i]];
    }
}

/* Return P_ff of the next sample. If x holds NaN, infinity or a number beyond 1e9, return NaN and
 * ignore the sample. */
static inline pff_real pff_step(pff_state *state, const pff_real x[PFF_INPUTS])
{
    pff_real beta[PFF_RULES], rule[PFF_RULES], nearest, away, total = 0, blended = 0;
    int i, j;

    for (i = 0; i < PFF_INPUTS; i++) {
        if (!pff_is_number(x[i])) {
            return (x[i] - x[i]) / (x[i] - x[i]); /* NaN */
        }
    }
    if (!state->streaming) {
        pff_reset(state, x);
    }
    for (j = PFF_ROW - 1; j >= 0; j--) {
        const pff_real u = x[pff_column[j]], r = pff_number[j];
        pff_real *p = &state->row[j];
        if (pff_kind[j] == 0) { /* the tap before it one sample later */
            *p = state->row[j - 1];
        } else if (pff_kind[j] == 1) { /* a low-pass, Eq. (6); r is epsilon */
            *p += r * (u - *p);
        } else { /* a play; r is its half-width, or 0 if the feature is the input itself */
            *p = *p < u - r ? u - r : *p > u + r ? u + r : *p;
        }
    }
    for (i = 0; i < PFF_RULES; i++) {
        beta[i] = 0; /* first the squared distance from the centre */
        rule[i] = pff_at_center[i];
        for (j = 0; j < PFF_ROW; j++) {
            away = state->row[j] - pff_centers[i][j];
            beta[i] += away * away;
            rule[i] += pff_weights[i][j] * away;
        }
    }
    nearest = beta[0];
    for (i = 1; i < PFF_RULES; i++) {
        nearest = beta[i] < nearest ? beta[i] : nearest;
    }
    for (i = 0; i < PFF_RULES; i++) {
        beta[i] = PFF_EXP((nearest - beta[i]) * pff_half_over_sigma2);
        total += beta[i];
        blended += beta[i] * rule[i];
    }
    blended /= total;
#ifdef PFF_LEARNS
    const unsigned long at = state->k++ % PFF_DELAY;
    pff_real *phi = state->phi[at], p_learned = 0;
    for (i = 0; i < PFF_RULES; i++) {
        phi[i * (PFF_ROW + 1)] = beta[i] / total;
        for (j = 0; j < PFF_ROW; j++) {
            phi[i * (PFF_ROW + 1) + 1 + j] = beta[i] / total * state->row[j];
        }
    }
    for (i = 0; i < PFF_WEIGHTS; i++) {
        p_learned += state->learned[i] * phi[i];
    }
    state->base[at] = blended;
    blended += p_learned > pff_limit ? pff_limit : p_learned < -pff_limit ? -pff_limit : p_learned;
    state->p_ff[at] = blended;
    state->p_fb[at] = 0;
#endif
    return blended;
}

#ifdef PFF_LEARNS
/* Return whether an angle can be true: in range, and no faster than the actuator can be. */
static inline int pff_believe(pff_state *state, pff_real theta)
{
    const pff_real moved = theta - state->believed;
    const int none = state->doubted == PFF_NONE;

    state->doubted += !none;
    if (!(theta >= -pff_farthest && theta <= pff_farthest)
        || (!none && (moved < 0 ? -moved : moved) > pff_fastest * (pff_real)state->doubted)) {
        return 0;
    }
    state->believed = theta;
    state->doubted = 0;
    return 1;
}

/* Note the feedback in kPa that was added to the last P_ff. */
static inline void pff_sent(pff_state *state, pff_real p_fb)
{
    if (state->k > 0) {
        state->p_fb[(state->k - 1) % PFF_DELAY] = p_fb;
    }
}

/* Learn from theta_d - theta and theta of this sample, deg, before its pff_step. Nothing is
 * learned while the actuator is at its stop, or the command or the learned part at a limit and
 * asked to go further; nor from an angle that is no number or cannot be true. */
static inline void pff_learn(pff_state *state, pff_real error, pff_real theta)
{
    const unsigned long then = state->k % PFF_DELAY;
    const pff_real *phi = state->phi[then];
    pff_real gains[PFF_WEIGHTS], given = 0, scale = 1, innovation, p_d, updated;
    int i, j;

    if (!pff_believe(state, theta) || !state->streaming || state->k < PFF_DELAY
        || !(error >= -pff_largest_error && error <= pff_largest_error)
        || !pff_is_number(state->p_fb[then])) {
        return;
    }
    p_d = state->p_ff[then] + state->p_fb[then];
    if (!(p_d <= 0 ? error > pff_stop : p_d >= pff_most ? error < -pff_stop : theta > pff_stop)) {
        return;
    }
    for (i = 0; i < PFF_WEIGHTS; i++) {
        given += state->learned[i] * phi[i];
        gains[i] = 0;
    }
    innovation = state->p_ff[then] + pff_kpa_per_deg * error - state->base[then] - given;
    if ((given >= pff_limit || given <= -pff_limit) && given * innovation >= 0) {
        return;
    }
    for (j = 0; j < PFF_WEIGHTS; j++) {
        for (i = 0; i < PFF_WEIGHTS; i++) {
            gains[i] += state->covariance[j][i] * phi[j];
        }
    }
    for (i = 0; i < PFF_WEIGHTS; i++) {
        scale += phi[i] * gains[i];
    }
    for (i = 0; i < PFF_WEIGHTS; i++) {
        state->learned[i] += gains[i] / scale * innovation;
        for (j = 0; j < PFF_WEIGHTS; j++) {
            updated = state->covariance[i][j] - gains[i] * gains[j] / scale;
            state->covariance[i][j] = updated + pff_mixing * (pff_prior[i][j] - updated);
        }
    }
}
#endif

#endif
