/* Feeds what it reads to the board of board_shim.c, a millisecond for each byte, and writes the answers. */
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

bool shim_reset(const char *called);
size_t shim_receive(const uint8_t *bytes, size_t count, uint32_t now_ms, uint8_t *answer);
void shim_turn(uint32_t now_ms, uint32_t board_ms, uint32_t frozen);

int main(void) {
    static uint8_t answer[8192];
    uint32_t now = 0;
    int read;
    if (!shim_reset("base") || shim_reset("a name that has too many bytes"))
        return 1;
    shim_reset("base");
    while ((read = getchar()) != EOF) {
        uint8_t byte = (uint8_t)read;
        fwrite(answer, 1, shim_receive(&byte, 1, now, answer), stdout);
        shim_turn(now, now, 0);
        now++;
    }
    return 0;
}
