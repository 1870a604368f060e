/* thermicon_player.h: plays exported icons on a microcontroller. Written by thermicon; never played on a device.

   Call thermicon_step() at a steady rate, at least every THERMICON_REACT_S, and in a play at least every two periods of
   the icon, since a slower one leaves out codes that were judged. It puts out zero, for good, when the measured
   temperature leaves THERMICON_LOW_C ... THERMICON_HIGH_C, a sensor is lost or frozen, the host has not called
   thermicon_feed() for THERMICON_WATCHDOG_S, the loop is late, its clock stands still, or thermicon_abort() was called;
   only thermicon_begin() leaves a fault. It does not replace a cut-off that works without software.
   A watchdog of 0 means that no hang is safe and the cut-off must protect: a sensor is then needed, and the host has
   THERMICON_REACT_S.

       thermicon_player player;
       thermicon_begin(&player, &board, THERMICON_ICON(cooling_step));   tests the polarity, then holds rest and pause
       thermicon_play(&player, THERMICON_ICON(cooling_step));            THERMICON_OK, or why not yet

   What the gate of safety says of these drives:
@VERDICTS@
*/
#ifndef THERMICON_PLAYER_H
#define THERMICON_PLAYER_H

#include <stddef.h>
#include <stdint.h>
#ifdef __AVR__
#include <avr/pgmspace.h>
#define THERMICON_CODE(wave, k) ((int16_t)pgm_read_word(&(wave)[k]))
#else
#define THERMICON_CODE(wave, k) ((wave)[k])
#ifndef PROGMEM
#define PROGMEM
#endif
#endif

#define THERMICON_CLOSED_LOOP @CLOSED_LOOP@ /* 1: codes are set-points of the loop below; 0: codes are put out */
#define THERMICON_WATCHDOG_S @WATCHDOG_S@
#define THERMICON_LOW_C @LOW_C@
#define THERMICON_HIGH_C @HIGH_C@
#define THERMICON_REACT_S @REACT_S@
#define THERMICON_REST_S @REST_S@
#define THERMICON_PAUSE_S @PAUSE_S@
#define THERMICON_SECOND_SENSOR @SECOND_SENSOR@ /* 1: the cut-off needs a sensor that the loop does not follow */
#define THERMICON_TEST_POLARITY @TEST_POLARITY@
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
/* A reading that stays, and for FROZEN_S at least, while the display is predicted to move by three steps, is frozen. */
#ifndef THERMICON_SENSOR_STEP_K
#define THERMICON_SENSOR_STEP_K 0.1f
#endif
#ifndef THERMICON_FROZEN_S
#define THERMICON_FROZEN_S 1.0f
#endif
/* A clock that reads the same in so many steps stands still. */
#ifndef THERMICON_CLOCK_STEPS
#define THERMICON_CLOCK_STEPS 100
#endif

/* The predicted display of each icon every THERMICON_COURSE_MS, in hundredths of a degree; with set-points these are
   the prediction. An icon of another export has none and does not compile: its numbers may be others. */
#define THERMICON_COURSE_MS @COURSE_MS@
@COURSES@

typedef enum { THERMICON_TESTING, THERMICON_RESTING, THERMICON_PLAYING, THERMICON_STOPPED } thermicon_state;

typedef enum {
    THERMICON_NO_FAULT,
    THERMICON_ABORTED,
    THERMICON_HOST_SILENT,
    THERMICON_LOOP_LATE,
    THERMICON_SENSOR_LOST,
    THERMICON_SENSOR_FROZEN,
    THERMICON_TOO_COLD,
    THERMICON_TOO_WARM,
    THERMICON_POLARITY_SWAPPED,
    THERMICON_CLOCK_STANDS
} thermicon_fault;

typedef enum {
    THERMICON_OK,
    THERMICON_NO_SENSOR,
    THERMICON_NOT_RESTED,
    THERMICON_TOO_SOON,
    THERMICON_BUSY,
    THERMICON_HAS_STOPPED,
    THERMICON_NO_CLOCK
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
} thermicon_board;

typedef struct {
    float reading_C, expected_C;
    uint64_t since_us;
    uint8_t known;
} thermicon_sensor;

typedef struct {
    const thermicon_board *board;
    thermicon_icon icon;
    thermicon_state state;
    thermicon_fault fault;
    uint64_t now_us, entered_us, fed_us; /* since thermicon_begin(), without wraps */
    uint32_t clock_us, place;
    uint16_t stands;
    float before_C, test_from_C, goal, integral;
    thermicon_sensor first, second;
    uint8_t has_stepped, has_played;
} thermicon_player;

/* Whole microseconds of a time in s, exact to one also where a double has 32 bits. */
static inline uint64_t thermicon_us(float time_s) {
    uint32_t whole = (uint32_t)time_s;
    return (uint64_t)whole * 1000000u + (uint64_t)((time_s - (float)whole) * 1e6f);
}

static inline thermicon_icon thermicon_icon_of(const int16_t *wave, uint32_t count, uint32_t period_ns, float offset,
                                               float step, const int16_t *course, uint32_t course_count) {
    thermicon_icon icon;
    icon.wave = wave;
    icon.count = count;
    icon.period_ns = period_ns;
    icon.offset = offset;
    icon.step = step;
    icon.course = course;
    icon.course_count = course_count;
    return icon;
}

#define THERMICON_ICON(name)                                                                                \
    thermicon_icon_of(name##_wave, name##_count, name##_period_ns, name##_offset, name##_step,              \
                      thermicon_course_##name, sizeof thermicon_course_##name / sizeof(int16_t))

static inline void thermicon_enter(thermicon_player *player, thermicon_state state) {
    player->state = state;
    player->entered_us = player->now_us;
    player->first.known = player->second.known = 0;
}

static inline void thermicon_stop(thermicon_player *player, thermicon_fault fault) {
    player->board->put_out(player->board->context, 0.0f);
    if (player->state != THERMICON_STOPPED) player->fault = fault;
    player->state = THERMICON_STOPPED;
}

/* Zero output at once, for good. */
static inline void thermicon_abort(thermicon_player *player) { thermicon_stop(player, THERMICON_ABORTED); }

/* The host is alive; call it from what the host sends, never from a timer of this board. */
static inline void thermicon_feed(thermicon_player *player) { player->fed_us = player->now_us; }

/* Begin at zero output: the polarity is tested, then the rest of the icon is held. */
static inline thermicon_answer thermicon_begin(thermicon_player *player, const thermicon_board *board,
                                               thermicon_icon icon) {
    const thermicon_sensor unread = {0.0f, 0.0f, 0, 0};
    int needs_sensor = THERMICON_CLOSED_LOOP || !(THERMICON_WATCHDOG_S > 0.0f);
    player->board = board;
    player->icon = icon;
    player->fault = THERMICON_NO_FAULT;
    player->now_us = player->fed_us = 0;
    player->clock_us = player->place = 0;
    player->stands = 0;
    player->before_C = player->test_from_C = player->goal = player->integral = 0.0f;
    player->first = player->second = unread;
    player->has_stepped = player->has_played = 0;
    thermicon_enter(player, THERMICON_TEST_POLARITY && board->measure ? THERMICON_TESTING : THERMICON_RESTING);
    board->put_out(board->context, 0.0f);
    if ((needs_sensor && !board->measure) || (THERMICON_SECOND_SENSOR && !board->measure_second)) {
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
    if (player->state == THERMICON_STOPPED) return THERMICON_HAS_STOPPED;
    if (player->state == THERMICON_PLAYING) return THERMICON_BUSY;
    if (player->state == THERMICON_TESTING) return THERMICON_NOT_RESTED;
    if (!player->has_played && held_us <= thermicon_us(THERMICON_REST_S)) return THERMICON_NOT_RESTED;
    if (held_us <= thermicon_us(THERMICON_PAUSE_S)) return player->has_played ? THERMICON_TOO_SOON : THERMICON_NOT_RESTED;
    player->icon = icon;
    player->place = 0;
    player->has_played = 1;
    thermicon_enter(player, THERMICON_PLAYING);
    return THERMICON_OK;
}

/* The predicted display in degrees C: the set-point of a loop, else the course of the icon. */
static inline float thermicon_expected(const thermicon_player *player) {
    const thermicon_icon *icon = &player->icon;
    uint64_t played_us = player->now_us - player->entered_us;
    uint32_t place = (uint32_t)(played_us / (1000UL * THERMICON_COURSE_MS));
    float part = (float)(played_us % (1000UL * THERMICON_COURSE_MS)) / (1000.0f * THERMICON_COURSE_MS), from;
    if (THERMICON_CLOSED_LOOP) return player->goal;
    if (place + 1 >= icon->course_count) return 0.01f * (float)THERMICON_CODE(icon->course, icon->course_count - 1);
    from = (float)THERMICON_CODE(icon->course, place);
    return 0.01f * (from + part * ((float)THERMICON_CODE(icon->course, place + 1) - from));
}

/* Reads a sensor and checks it; 0 where the player has stopped over it. */
static inline int thermicon_look(thermicon_player *player, thermicon_sensor *sensor,
                                 int (*measure)(void *context, float *display_C)) {
    float now = 0.0f, moved, expected;
    if (!measure) return 1;
    if (!measure(player->board->context, &now) ||
        !(now > THERMICON_SENSOR_LOW_C && now < THERMICON_SENSOR_HIGH_C)) { /* not a number fails too */
        thermicon_stop(player, THERMICON_SENSOR_LOST);
        return 0;
    }
    if (now < THERMICON_LOW_C || now > THERMICON_HIGH_C) {
        thermicon_stop(player, now < THERMICON_LOW_C ? THERMICON_TOO_COLD : THERMICON_TOO_WARM);
        return 0;
    }
    expected = player->state == THERMICON_PLAYING ? thermicon_expected(player) : 0.0f;
    moved = expected - sensor->expected_C;
    if (!sensor->known || now < sensor->reading_C || now > sensor->reading_C) {
        sensor->known = 1;
        sensor->reading_C = now;
        sensor->expected_C = expected;
        sensor->since_us = player->now_us;
    } else if (player->now_us - sensor->since_us > thermicon_us(THERMICON_FROZEN_S) &&
               (moved > 3.0f * THERMICON_SENSOR_STEP_K || moved < -3.0f * THERMICON_SENSOR_STEP_K)) {
        thermicon_stop(player, THERMICON_SENSOR_FROZEN);
        return 0;
    }
    return 1;
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
    if (player->state == THERMICON_PLAYING && two_periods < most) most = two_periods;
    if (!player->has_stepped) elapsed = 0;
    player->clock_us = now;
    player->stands = elapsed || !player->has_stepped ? 0 : (uint16_t)(player->stands + 1);
    if (elapsed > most) thermicon_stop(player, THERMICON_LOOP_LATE);
    if (player->stands >= THERMICON_CLOCK_STEPS) thermicon_stop(player, THERMICON_CLOCK_STANDS);
    player->now_us += elapsed;
    return elapsed;
}

/* One turn; returns the state. */
static inline thermicon_state thermicon_step(thermicon_player *player) {
    const thermicon_board *board = player->board;
    uint64_t watchdog = thermicon_us(THERMICON_WATCHDOG_S > 0.0f ? THERMICON_WATCHDOG_S : THERMICON_REACT_S), in_state;
    uint32_t elapsed;
    if (player->state == THERMICON_STOPPED) {
        board->put_out(board->context, 0.0f);
        return player->state;
    }
    elapsed = thermicon_elapsed(player);
    if (player->state == THERMICON_STOPPED) return player->state;
    if (player->now_us - player->fed_us > watchdog) {
        thermicon_stop(player, THERMICON_HOST_SILENT);
        return player->state;
    }
    if (!thermicon_look(player, &player->first, board->measure)) return player->state;
    if (!thermicon_look(player, &player->second, board->measure_second)) return player->state;
    if (!player->has_stepped) {
        player->test_from_C = player->before_C = player->first.reading_C;
        player->has_stepped = 1;
    } else if (!elapsed) { /* a coarse clock: what is put out goes on until its next tick */
        return player->state;
    }
    in_state = player->now_us - player->entered_us;
    if (player->state == THERMICON_TESTING) {
        if (in_state <= thermicon_us(THERMICON_TEST_S)) {
            board->put_out(board->context, THERMICON_TEST_COMMAND);
            return player->state;
        }
        if (player->test_from_C - player->first.reading_C < THERMICON_TEST_FALL_K) {
            thermicon_stop(player, THERMICON_POLARITY_SWAPPED);
            return player->state;
        }
        thermicon_enter(player, THERMICON_RESTING);
    }
    if (player->state == THERMICON_PLAYING) {
        player->place = (uint32_t)(in_state * 1000u / player->icon.period_ns);
        if (player->place >= player->icon.count - 1) thermicon_enter(player, THERMICON_RESTING);
    }
    player->goal = player->icon.offset +
                   player->icon.step * (float)THERMICON_CODE(player->icon.wave,
                                                             player->state == THERMICON_PLAYING ? player->place : 0);
    board->put_out(board->context,
                   THERMICON_CLOSED_LOOP ? thermicon_regulate(player, 1e-6f * (float)elapsed) : player->goal);
    return player->state;
}

#endif
