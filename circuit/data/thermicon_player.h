/* thermicon_player.h: plays exported icons on a microcontroller. Written by thermicon; never played on a device.

   Call thermicon_step() at a steady rate, at least every THERMICON_REACT_S; where codes are put out, in a play at least
   every two periods of the icon, since a slower one leaves out codes that were judged. It puts out zero, for good, when
   a measured temperature leaves THERMICON_LOW_C ... THERMICON_HIGH_C or is beyond THERMICON_HELD_LOW_C ...
   THERMICON_HELD_HIGH_C for too long, a sensor is lost or frozen, two sensors disagree, a loop leaves its course, the
   host has not called thermicon_feed() for THERMICON_WATCHDOG_S, this loop is late, its clock stands still, or
   thermicon_abort() was called; only thermicon_begin() leaves a fault. It does not replace a cut-off that works without
   software. An interrupt may call thermicon_abort(), if it may call put_out, and thermicon_feed(); nothing else.

       thermicon_player player;
       thermicon_begin(&player, &board, THERMICON_ICON(cooling_step));   off, polarity test, then rest and pause
       thermicon_play(&player, THERMICON_ICON(cooling_step));            THERMICON_OK, or why not yet

   What the gate of safety says of these drives:
@VERDICTS@
*/
#ifndef THERMICON_PLAYER_H
#define THERMICON_PLAYER_H

#include <stddef.h>
#include <stdint.h>
#include <string.h>
#ifdef __AVR__
#include <avr/pgmspace.h>
#define THERMICON_CODE(wave, k) ((int16_t)pgm_read_word(&(wave)[k]))
#else
#define THERMICON_CODE(wave, k) ((wave)[k])
#ifndef PROGMEM
#define PROGMEM
#endif
#endif

/* Which export this is: the first 16 digits of the SHA-256 of the drives in the order of their names, and of this file
   after them, with zeros for these digits. */
#define THERMICON_DIGEST "@DIGEST@"
#define THERMICON_NAMES @NAMES@
/* The host may be silent for so long: define a shorter time before the include; a longer one is cut. */
#define THERMICON_JUDGED_WATCHDOG_S @WATCHDOG_S@
#ifndef THERMICON_WATCHDOG_S
#define THERMICON_WATCHDOG_S @WATCHDOG_S@
#endif

#define THERMICON_CLOSED_LOOP @CLOSED_LOOP@ /* 1: codes are set-points of the loop below; 0: codes are put out */
#define THERMICON_LOW_C @LOW_C@
#define THERMICON_HIGH_C @HIGH_C@
#define THERMICON_HELD_LOW_C @HELD_LOW_C@ /* second cut-off, after HELD_S beyond it; the first and 0 s: not needed */
#define THERMICON_HELD_HIGH_C @HELD_HIGH_C@
#define THERMICON_HELD_S @HELD_S@
#define THERMICON_REACT_S @REACT_S@
#define THERMICON_REST_S @REST_S@
#define THERMICON_PAUSE_S @PAUSE_S@
#define THERMICON_NEEDS_SENSOR @NEEDS_SENSOR@ /* 1: for a loop, or since no hang is safe without the cut-off */
#define THERMICON_SECOND_SENSOR @SECOND_SENSOR@ /* 1: the cut-off needs a sensor that the loop does not follow */
#define THERMICON_TEST_POLARITY @TEST_POLARITY@
#define THERMICON_OFF_S @OFF_S@ /* off before the test, so that no current before it moves the display */
#define THERMICON_TEST_COMMAND @TEST_COMMAND@ /* @TEST_UNIT@; cools */
#define THERMICON_TEST_S @TEST_S@
#define THERMICON_TEST_FALL_K @TEST_FALL_K@

/* With set-points, the loop that was judged (otherwise not used): gains in A/K, A/(K s) and A s/K, and current limits,
   which the output never leaves. */
#define THERMICON_KP @KP@
#define THERMICON_KI @KI@
#define THERMICON_KD @KD@
#define THERMICON_LOWEST_A @LOWEST_A@
#define THERMICON_HIGHEST_A @HIGHEST_A@

/* A thermistor that is open or shorted reads far outside these. */
#ifndef THERMICON_SENSOR_LOW_C
#define THERMICON_SENSOR_LOW_C (-20.0f)
#define THERMICON_SENSOR_HIGH_C 120.0f
#endif
/* A reading that has stayed for FROZEN_S, in which a late sensor catches up, is frozen if it stays for FROZEN_S more
   after the other sensor has moved by three steps; or the prediction, where there is no other one or it stays too. */
#ifndef THERMICON_SENSOR_STEP_K
#define THERMICON_SENSOR_STEP_K 0.1f
#endif
#ifndef THERMICON_FROZEN_S
#define THERMICON_FROZEN_S 1.0f
#endif
/* Sensors of one display are no farther apart for longer; the second one may read what the first did LAG_S before. */
#define THERMICON_APART_K 1.0f
#define THERMICON_APART_S 0.3f
#define THERMICON_LAG_S 0.3f
/* What a loop's own sensor reads in a play is no farther from the predicted course for longer. */
#define THERMICON_OFF_COURSE_K 1.5f
#define THERMICON_OFF_COURSE_S 1.0f
/* A clock that reads the same in so many steps stands still. */
#ifndef THERMICON_CLOCK_STEPS
#define THERMICON_CLOCK_STEPS 100
#endif

/* The predicted display of each icon every THERMICON_COURSE_MS, in hundredths of a degree; set-points lie beside it. An
   icon of another export has none and does not compile: its numbers may be others. */
#define THERMICON_COURSE_MS @COURSE_MS@
@COURSES@

/* THERMICON_OFF comes before the test, and THERMICON_STOPPED is off for good. */
typedef enum { THERMICON_TESTING, THERMICON_RESTING, THERMICON_PLAYING, THERMICON_STOPPED, THERMICON_OFF }
    thermicon_state;

typedef enum {
    THERMICON_NO_FAULT, THERMICON_ABORTED, THERMICON_HOST_SILENT, THERMICON_LOOP_LATE,
    THERMICON_SENSOR_LOST, THERMICON_SENSOR_FROZEN, THERMICON_TOO_COLD, THERMICON_TOO_WARM,
    THERMICON_POLARITY_SWAPPED, THERMICON_CLOCK_STANDS, THERMICON_SENSORS_APART, THERMICON_OFF_COURSE,
    THERMICON_HELD_TOO_LONG
} thermicon_fault;

typedef enum {
    THERMICON_OK, THERMICON_NO_SENSOR, THERMICON_NOT_RESTED, THERMICON_TOO_SOON, THERMICON_BUSY,
    THERMICON_HAS_STOPPED, THERMICON_NO_CLOCK
} thermicon_answer;

typedef struct {
    const int16_t *wave;
    uint32_t count, period_ns;
    float offset, step; /* command, or temperature in degrees C, = offset + step * code */
    const int16_t *course;
    uint32_t course_count;
} thermicon_icon;

typedef struct {
    /* Measured temperature of the display in degrees C; returns 0 where there is none. NULL: no sensor, which leaves
       an open loop without cut-off and polarity test, and is refused for a closed one. */
    int (*measure)(void *context, float *display_C);
    void (*put_out)(void *context, float command); /* @OUTPUT_UNIT@; above 0 cools, 0 is off */
    void *context;
    /* PI(D) loop on the measured temperature, for set-points only: A/K, A/(K s), A s/K, least and most output in A.
       Use those that were judged: THERMICON_KP, THERMICON_KI, THERMICON_KD, THERMICON_LOWEST_A, THERMICON_HIGHEST_A. */
    float kp, ki, kd, lowest, highest;
    /* Microseconds of a clock that only goes on, such as micros(); it may wrap at 2^32. Boards that were written for
       thermicon_step(player, elapsed_s) lack it, and thermicon_begin() answers THERMICON_NO_CLOCK. */
    uint32_t (*now_us)(void *context);
    /* A second sensor of the display, as `measure`, that the loop does not follow: the cut-off acts on both. NULL is
       refused where THERMICON_SECOND_SENSOR is 1. */
    int (*measure_second)(void *context, float *display_C);
    /* An output pin for recordings: 1 at the first code of an icon, 0 at the last one and at a stop. May be NULL. */
    void (*mark)(void *context, int on);
} thermicon_board;

typedef struct {
    float reading_C, test_from_C, other_C, expected_C; /* the last two: when the reading had stayed for FROZEN_S */
    uint64_t stays_us, frozen_us, beyond_us;
} thermicon_sensor;

typedef struct {
    const thermicon_board *board;
    thermicon_icon icon;
    thermicon_state state;
    thermicon_fault fault;
    uint64_t now_us, entered_us, fed_us; /* since thermicon_begin(), from 1 on, without wraps */
    uint64_t apart_us, beside_us;
    uint32_t clock_us, place;
    uint16_t stands;
    float before_C, late_C, goal, integral; /* late_C: the first sensor's, THERMICON_LAG_S late */
    thermicon_sensor first, second;
    uint8_t has_stepped, has_played, marked;
    volatile uint8_t aborted, fed; /* set by an interrupt, which may come in the middle of a step */
} thermicon_player;

/* Whole microseconds of a time in s, exact to one also where a double has 32 bits. */
static inline uint64_t thermicon_us(float time_s) {
    uint32_t whole = (uint32_t)time_s;
    return (uint64_t)whole * 1000000u + (uint64_t)((time_s - (float)whole) * 1e6f);
}

static inline thermicon_icon thermicon_icon_of(const int16_t *wave, uint32_t count, uint32_t period_ns, float offset,
                                               float step, const int16_t *course, uint32_t course_count) {
    thermicon_icon icon = {wave, count, period_ns, offset, step, course, course_count};
    return icon;
}

#define THERMICON_ICON(name)                                                                                \
    thermicon_icon_of(name##_wave, name##_count, name##_period_ns, name##_offset, name##_step,              \
                      thermicon_course_##name, sizeof thermicon_course_##name / sizeof(int16_t))

static inline void thermicon_enter(thermicon_player *player, thermicon_state state) {
    player->state = state;
    player->entered_us = player->now_us;
    player->before_C = player->late_C = player->first.reading_C;
}

static inline void thermicon_mark(thermicon_player *player, uint8_t on) {
    if (player->board->mark && player->marked != on) player->board->mark(player->board->context, on);
    player->marked = on;
}

static inline void thermicon_stop(thermicon_player *player, thermicon_fault fault) {
    player->board->put_out(player->board->context, 0.0f);
    thermicon_mark(player, 0);
    if (player->state != THERMICON_STOPPED) player->fault = fault;
    player->state = THERMICON_STOPPED;
}

/* Zero output at once, for good; a step that it interrupts, or the next one, tells it as a fault. */
static inline void thermicon_abort(thermicon_player *player) {
    player->aborted = 1;
    player->board->put_out(player->board->context, 0.0f);
}

/* The host is alive; call it from what the host sends, never from a timer of this board. */
static inline void thermicon_feed(thermicon_player *player) { player->fed = 1; }

/* Begin at zero output: after a time off the polarity is tested, then the rest of the icon is held. */
static inline thermicon_answer thermicon_begin(thermicon_player *player, const thermicon_board *board,
                                               thermicon_icon icon) {
    memset(player, 0, sizeof *player);
    player->board = board;
    player->icon = icon;
    player->now_us = player->fed_us = 1; /* 0 is never */
    player->marked = 1; /* whatever the pin showed before */
    thermicon_enter(player, THERMICON_TEST_POLARITY && board->measure ? THERMICON_OFF : THERMICON_RESTING);
    board->put_out(board->context, 0.0f);
    thermicon_mark(player, 0);
    if ((THERMICON_NEEDS_SENSOR && !board->measure) || (THERMICON_SECOND_SENSOR && !board->measure_second)) {
        thermicon_stop(player, THERMICON_SENSOR_LOST);
        return THERMICON_NO_SENSOR;
    }
    if (!board->now_us) {
        thermicon_stop(player, THERMICON_CLOCK_STANDS);
        return THERMICON_NO_CLOCK;
    }
    return THERMICON_OK;
}

/* Play an icon, or say why not yet: the rest was not held long enough, or the pause after the last play was not. Before
   the first play the pause is held too, since nobody knows what played before this board was started. */
static inline thermicon_answer thermicon_play(thermicon_player *player, thermicon_icon icon) {
    uint64_t held_us = player->now_us - player->entered_us;
    if (player->state == THERMICON_STOPPED || player->aborted) return THERMICON_HAS_STOPPED;
    if (player->state == THERMICON_PLAYING) return THERMICON_BUSY;
    if (player->state != THERMICON_RESTING) return THERMICON_NOT_RESTED;
    if (!player->has_played && held_us <= thermicon_us(THERMICON_REST_S)) return THERMICON_NOT_RESTED;
    if (held_us <= thermicon_us(THERMICON_PAUSE_S)) return player->has_played ? THERMICON_TOO_SOON : THERMICON_NOT_RESTED;
    player->icon = icon;
    player->place = 0;
    player->has_played = 1;
    thermicon_enter(player, THERMICON_PLAYING);
    return THERMICON_OK;
}

/* The predicted display in degrees C: the course of the icon, and in a rest where it begins. */
static inline float thermicon_expected(const thermicon_player *player) {
    const thermicon_icon *icon = &player->icon;
    uint64_t played_us = player->state == THERMICON_PLAYING ? player->now_us - player->entered_us : 0;
    uint32_t place = (uint32_t)(played_us / (1000UL * THERMICON_COURSE_MS));
    float part = (float)(played_us % (1000UL * THERMICON_COURSE_MS)) / (1000.0f * THERMICON_COURSE_MS), from;
    if (place + 1 >= icon->course_count) return 0.01f * (float)THERMICON_CODE(icon->course, icon->course_count - 1);
    from = (float)THERMICON_CODE(icon->course, place);
    return 0.01f * (from + part * ((float)THERMICON_CODE(icon->course, place + 1) - from));
}

/* Stops what has been so for longer than a time; `since_us` is when it was first seen so, 0 while it is not. */
static inline void thermicon_limit(thermicon_player *player, int is_so, uint64_t *since_us, float longest_s,
                                   thermicon_fault fault) {
    if (!is_so || !*since_us) *since_us = is_so ? player->now_us : 0;
    if (is_so && player->now_us - *since_us > thermicon_us(longest_s)) thermicon_stop(player, fault);
}

static inline int thermicon_exceeds(float difference, float most) { return difference > most || difference < -most; }

/* Checks what a sensor reads, and stops over it. A sensor that a board does not have reads 0 and stays. */
static inline void thermicon_check(thermicon_player *player, thermicon_sensor *sensor, const thermicon_sensor *other) {
    float now = sensor->reading_C, expected = thermicon_expected(player), moved;
    int is_held = player->state != THERMICON_OFF && (now < THERMICON_HELD_LOW_C || now > THERMICON_HELD_HIGH_C);
    if (now < THERMICON_LOW_C) thermicon_stop(player, THERMICON_TOO_COLD);
    if (now > THERMICON_HIGH_C) thermicon_stop(player, THERMICON_TOO_WARM);
    thermicon_limit(player, is_held, &sensor->beyond_us, THERMICON_HELD_S, THERMICON_HELD_TOO_LONG);
    if (player->now_us - sensor->stays_us <= thermicon_us(THERMICON_FROZEN_S)) {
        sensor->other_C = other->reading_C;
        sensor->expected_C = expected;
    }
    moved = other->reading_C - sensor->other_C;
    if (!thermicon_exceeds(moved, 0.0f)) moved = expected - sensor->expected_C;
    thermicon_limit(player, thermicon_exceeds(moved, 3.0f * THERMICON_SENSOR_STEP_K), &sensor->frozen_us,
                    THERMICON_FROZEN_S, THERMICON_SENSOR_FROZEN);
}

static inline void thermicon_read(thermicon_player *player, thermicon_sensor *sensor,
                                  int (*measure)(void *context, float *display_C)) {
    float now = sensor->reading_C;
    int has_read = measure(player->board->context, &now);
    if (!has_read || !(now > THERMICON_SENSOR_LOW_C && now < THERMICON_SENSOR_HIGH_C)) /* not a number fails too */
        thermicon_stop(player, THERMICON_SENSOR_LOST);
    if (now < sensor->reading_C || now > sensor->reading_C) sensor->stays_us = player->now_us;
    sensor->reading_C = now;
}

/* A second sensor that is late reads between the first one and `late_C`, which follows it. */
static inline int thermicon_are_apart(const thermicon_player *player) {
    float first = player->first.reading_C, late = player->late_C, second = player->second.reading_C;
    float lowest = first < late ? first : late, highest = first < late ? late : first;
    return second < lowest - THERMICON_APART_K || second > highest + THERMICON_APART_K;
}

static inline void thermicon_look(thermicon_player *player, float elapsed_s) {
    thermicon_sensor *first = &player->first, *second = &player->second;
    int has_first = player->board->measure != NULL, has_second = player->board->measure_second != NULL, is_apart;
    float beside_K;
    if (has_first) thermicon_read(player, first, player->board->measure);
    if (has_second) thermicon_read(player, second, player->board->measure_second);
    if (player->state == THERMICON_STOPPED) return;
    if (has_first) thermicon_check(player, first, second);
    if (has_second) thermicon_check(player, second, first);
    player->late_C += (first->reading_C - player->late_C) * elapsed_s / (THERMICON_LAG_S + elapsed_s);
    is_apart = has_first && has_second && thermicon_are_apart(player);
    thermicon_limit(player, is_apart, &player->apart_us, THERMICON_APART_S, THERMICON_SENSORS_APART);
    beside_K = player->state == THERMICON_PLAYING ? first->reading_C - thermicon_expected(player) : 0.0f;
    thermicon_limit(player, THERMICON_CLOSED_LOOP && thermicon_exceeds(beside_K, THERMICON_OFF_COURSE_K),
                    &player->beside_us, THERMICON_OFF_COURSE_S, THERMICON_OFF_COURSE);
}

/* The loop: too warm asks for current that cools. The integral stops where the output is at its limit. */
static inline float thermicon_regulate(thermicon_player *player, float elapsed_s) {
    const thermicon_board *board = player->board;
    float measured = player->first.reading_C, error = measured - player->goal;
    float rate = elapsed_s > 0.0f ? (measured - player->before_C) / elapsed_s : 0.0f;
    float sum = player->integral + board->ki * error * elapsed_s;
    float out = board->kp * error + sum + board->kd * rate;
    float highest = board->highest < THERMICON_HIGHEST_A ? board->highest : THERMICON_HIGHEST_A;
    float lowest = board->lowest > THERMICON_LOWEST_A ? board->lowest : THERMICON_LOWEST_A;
    player->before_C = measured;
    if (out > highest) return highest;
    if (out < lowest) return lowest;
    player->integral = sum;
    return out;
}

/* The time since the last step in us; a step that is too late, or a clock that goes back or stands still, stops. */
static inline uint32_t thermicon_elapsed(thermicon_player *player) {
    uint32_t now = player->board->now_us(player->board->context), elapsed = now - player->clock_us;
    uint64_t most = thermicon_us(THERMICON_REACT_S), two_periods = (uint64_t)player->icon.period_ns * 2u / 1000u;
    if (!THERMICON_CLOSED_LOOP && player->state == THERMICON_PLAYING && two_periods < most) most = two_periods;
    if (!player->has_stepped) elapsed = 0;
    player->clock_us = now;
    player->stands = elapsed || !player->has_stepped ? 0 : (uint16_t)(player->stands + 1);
    if (elapsed > most) thermicon_stop(player, THERMICON_LOOP_LATE);
    if (player->stands >= THERMICON_CLOCK_STEPS) thermicon_stop(player, THERMICON_CLOCK_STANDS);
    player->now_us += elapsed;
    return elapsed;
}

/* Goes on to the next state when the time of this one is over; for PLAYING it finds the place in the icon. */
static inline void thermicon_go_on(thermicon_player *player) {
    thermicon_sensor *first = &player->first, *second = &player->second;
    uint64_t in_state = player->now_us - player->entered_us;
    if (player->state == THERMICON_OFF && in_state > thermicon_us(THERMICON_OFF_S)) {
        first->test_from_C = first->reading_C;
        second->test_from_C = second->reading_C;
        thermicon_enter(player, THERMICON_TESTING);
    } else if (player->state == THERMICON_TESTING && in_state > thermicon_us(THERMICON_TEST_S)) {
        thermicon_enter(player, THERMICON_RESTING);
        if (first->test_from_C - first->reading_C < THERMICON_TEST_FALL_K ||
            (player->board->measure_second && second->test_from_C - second->reading_C < THERMICON_TEST_FALL_K))
            thermicon_stop(player, THERMICON_POLARITY_SWAPPED);
    } else if (player->state == THERMICON_PLAYING) {
        player->place = (uint32_t)(in_state * 1000u / player->icon.period_ns);
        if (player->place >= player->icon.count - 1) thermicon_enter(player, THERMICON_RESTING);
    }
}

/* One turn; returns the state. */
static inline thermicon_state thermicon_step(thermicon_player *player) {
    const thermicon_board *board = player->board;
    uint32_t elapsed, place;
    float out;
    if (player->aborted) thermicon_stop(player, THERMICON_ABORTED);
    if (player->state == THERMICON_STOPPED) {
        board->put_out(board->context, 0.0f);
        return player->state;
    }
    if (player->fed) player->fed_us = player->now_us;
    player->fed = 0;
    elapsed = thermicon_elapsed(player);
    if (player->now_us - player->fed_us > thermicon_us(THERMICON_WATCHDOG_S) ||
        player->now_us - player->fed_us > thermicon_us(THERMICON_JUDGED_WATCHDOG_S))
        thermicon_stop(player, THERMICON_HOST_SILENT);
    if (player->state != THERMICON_STOPPED) thermicon_look(player, 1e-6f * (float)elapsed);
    if (player->state == THERMICON_STOPPED) return player->state;
    if (player->has_stepped && !elapsed) return player->state; /* a coarse clock: what is put out goes on */
    player->has_stepped = 1;
    thermicon_go_on(player);
    if (player->state == THERMICON_STOPPED) return player->state;
    place = player->state == THERMICON_PLAYING ? player->place : 0;
    out = player->goal = player->icon.offset + player->icon.step * (float)THERMICON_CODE(player->icon.wave, place);
    if (player->state == THERMICON_OFF)
        out = 0.0f;
    else if (player->state == THERMICON_TESTING)
        out = THERMICON_TEST_COMMAND;
    else if (THERMICON_CLOSED_LOOP)
        out = thermicon_regulate(player, 1e-6f * (float)elapsed);
    board->put_out(board->context, out);
    thermicon_mark(player, player->state == THERMICON_PLAYING);
    if (player->aborted) thermicon_stop(player, THERMICON_ABORTED); /* its zero may have come before `out` */
    return player->state;
}

#endif
