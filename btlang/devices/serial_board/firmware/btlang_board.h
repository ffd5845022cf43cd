/* The board's side of the protocol of btlang's driver `serial-board`, in plain C99, without allocation.
 *
 * Each byte is in docs/serial-board.md of btlang. firmware.ino beside this file shows how it is used:
 * call btlang_begin once, btlang_receive with each byte that comes, and btlang_turn each time around, at least every
 * 10 ms; set readings when there are new samples, and do what `apply` says. All angles are counter-clockwise positive.
 */
#ifndef BTLANG_BOARD_H
#define BTLANG_BOARD_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#define BTLANG_VERSION 1
#define BTLANG_SILENCE_MS 180 /* without a command what moves comes to rest: all is at rest in 200 ms */
#define BTLANG_MOST 250       /* bytes of a message with its CRC */
#define BTLANG_NAME 24        /* bytes of the name of a board at most */
#define BTLANG_TEXT 32        /* bytes of the text on a display */
#define BTLANG_UNKNOWN INT16_MIN /* for values that a sensor doesn't measure; below are those of other widths */
#define BTLANG_UNKNOWN_HEADING INT32_MIN
#define BTLANG_UNKNOWN_8 INT8_MIN
#define BTLANG_UNKNOWN_VOLTS UINT16_MAX
#define BTLANG_NOTHING_IN_RANGE UINT16_MAX
#define BTLANG_ANY_SPEED UINT16_MAX

enum {
    BTLANG_RANGE = 1,
    BTLANG_DRIVE,
    BTLANG_IMU,
    BTLANG_BATTERY,
    BTLANG_BUTTON,
    BTLANG_JOINT,
    BTLANG_LIGHT,
    BTLANG_DISPLAY
};

/* The command of a channel; all zero is rest. */
typedef union {
    struct {
        int16_t left, right; /* mm/s */
    } drive;
    struct {
        bool loose, goes;  /* without torque; to `position`, else it stays */
        int32_t position;  /* 0.01 degrees */
        uint16_t speed;    /* 0.1 degrees a second at most, BTLANG_ANY_SPEED for no limit */
    } joint;
    struct {
        uint8_t red, green, blue;
    } light;
    char text[BTLANG_TEXT + 1];
} btlang_command;

typedef struct {
    /* Fill these. */
    uint8_t number; /* what the robot file calls `channel` */
    uint8_t kind;
    uint16_t interval_ms; /* between two samples at most; if it takes three times as long the sensor isn't believed */
    /* Read this. */
    btlang_command command;
    /* These are the library's. */
    uint8_t count;
    uint8_t reading[14];
    bool told;
    uint32_t told_ms;
} btlang_channel;

typedef struct {
    const char *name;
    btlang_channel *channels;
    uint8_t channel_count;
    void (*write)(const uint8_t *bytes, size_t count); /* to the line */
    void (*apply)(btlang_channel *channel);            /* does what channel->command says, at once */
    uint16_t session;
    uint16_t received;
    uint8_t frame[BTLANG_MOST + 2];
} btlang_board;

/* Fill name, channels, channel_count, write and apply before. Returns false where the channels don't fit in a frame, the name is
 * too long, or a kind is unknown. */
bool btlang_begin(btlang_board *board);
void btlang_receive(btlang_board *board, uint8_t byte, uint32_t now_ms);
void btlang_turn(btlang_board *board, uint32_t now_ms);

/* New samples. */
void btlang_set_range(btlang_channel *channel, uint16_t mm);
void btlang_set_drive(btlang_channel *channel, int32_t left_tenths_mm, int32_t right_tenths_mm, int16_t left_mm_s, int16_t right_mm_s);
void btlang_set_imu(btlang_channel *channel, int32_t turning_centidegrees_s, int16_t ahead_cm_s2, int16_t left_cm_s2,
                    int16_t up_cm_s2, int32_t heading_centidegrees);
void btlang_set_battery(btlang_channel *channel, uint16_t hundredths_percent, uint16_t millivolts, int16_t centiamperes,
                        int16_t tenths_celsius, uint8_t charging); /* 0 no, 1 yes, 2 unknown */
void btlang_set_button(btlang_channel *channel, bool pressed);
void btlang_set_joint(btlang_channel *channel, int32_t centidegrees, int16_t tenths_degrees_s, int8_t load_percent,
                      int8_t celsius, bool loose);

#ifdef __cplusplus
}
#endif
#endif
