// One channel of a memory, law 4 of the kernel: a controller with one decision per cycle. First ready, first come; at most CAP times past the oldest.
//
// A burst takes part from the cycle after its arrival, or after the column command that made room in the window. The column command of a burst
// decides its row commands as well: they are dated back to their earliest cycles, as the model does. `start` accepts a burst, and output 0 names the burst
// of each column command with its row outcome (0 hit, 1 closed, 2 conflict). BUS: commands per cycle, or 0 for any number. HISTORY bounds the cycles
// for which a burst waits in the window.
`default_nettype none
module channel #(parameter WINDOW = 8, CAP = 16, BANKS = 4, QUEUE = 64, CL = 3, CWL = 1, RCD = 3, RP = 3, RAS = 6, RTP = 1, WR = 2, WTR = 1, RRD = 2,
        FAW = 8, REFI = 0, RFC = 0, BURST = 2, BUS = 1, HISTORY = 256) (
    input  wire               clk, rst,
    input  wire               in0_valid,
    input  wire [`IN0_W-1:0]  in0,
    output wire               in0_pop,
    input  wire               out0_room,
    output wire               out0_reserve, out0_push,
    output reg  [`OUT0_W-1:0] out0,
    output wire               start
);
    localparam READ_TO_WRITE = CL + BURST + 1 > CWL + BURST ? CL + BURST + 1 - CWL : BURST, WRITE_TO_READ = CWL + BURST + WTR, Q = $clog2(QUEUE);
    localparam B = BANKS > 1 ? $clog2(BANKS) : 1, HIT = 0, EMPTY = 1, CONFLICT = 2;
    reg [31:0] now;
    // Bursts in view, the oldest first, and the cycles from which they are.
    reg [`IN0_W-1:0] burst [0:WINDOW];
    reg [31:0] from [0:WINDOW];
    reg [7:0] held, passed;
    // Bursts behind the window.
    reg [`IN0_W-1:0] behind [0:QUEUE-1];
    reg [Q:0] waiting;
    reg [Q-1:0] head, tail;
    // Banks: open row, earliest column command, earliest precharge or activation.
    reg [`IN0_row_N-1:0] row [0:BANKS-1];
    reg [BANKS-1:0] open;
    reg [31:0] ready [0:BANKS-1], free [0:BANKS-1];
    // Earliest next column command by direction, and earliest next activation: after the last one, and after the fourth last.
    reg [31:0] bus_read, bus_write, activation, four [0:3];
    // Cycles with a command, the last one first, and the cycles after the last column commands. No row command precedes the one that made room.
    reg [HISTORY-1:0] history;
    reg [31:0] made_room [0:WINDOW-1];
    localparam [HISTORY-1:0] ONE = 1, TOO_LATE = RCD > 0 ? (ONE << (RCD - 1)) - ONE : 0;
    wire [HISTORY-1:0] unused = ~history, unused_twice = unused & (~(history >> RP));
    reg [HISTORY-1:0] fits, chosen_fits;
    reg [31:0] age;
    integer i;
    reg found;
    reg [7:0] place;
    reg [1:0] outcome;
    reg [31:0] chosen_activation;
    reg [1:0] state;
    reg [31:0] earliest, at, rest;
    reg [B-1:0] bank;
    always @* begin
        found = 1'b0;
        place = 0;
        outcome = HIT;
        chosen_activation = 0;
        state = HIT;
        earliest = 0;
        at = 0;
        rest = 0;
        bank = 0;
        age = 0;
        fits = 0;
        chosen_fits = 0;
        for (i = WINDOW - 1; i >= 0; i = i - 1)
            if (i < held && (i == 0 || passed < CAP)) begin
                bank = burst[i][`IN0_bank +: B];
                state = !open[bank] ? EMPTY : row[bank] == burst[i][`IN0_row +: `IN0_row_N] ? HIT : CONFLICT;
                rest = free[bank] > from[i] ? free[bank] : from[i];
                if (state == CONFLICT) rest = rest + RP;
                earliest = rest > activation ? rest : activation;
                if (four[3] > earliest) earliest = four[3];
                rest = made_room[WINDOW-1] + (state == CONFLICT ? RP : 0);
                if (BUS != 0 && rest > earliest) earliest = rest;
                at = state == HIT ? ready[bank] : earliest + RCD;
                age = now - earliest;
                fits = (state == CONFLICT ? unused_twice : unused) & ~TOO_LATE & (age < HISTORY ? (ONE << age) - ONE : {HISTORY{1'b1}});
                if (at <= now && (BUS == 0 || state == HIT || fits != 0) && from[i] <= now && (burst[i][`IN0_write] ? bus_write : bus_read) <= now) begin
                    found = 1'b1;
                    place = i;
                    outcome = state;
                    chosen_activation = earliest;
                    chosen_fits = fits;
                end
            end
        // The earliest cycle with room on the command bus.
        if (BUS != 0 && outcome != HIT)
            for (i = 0; i < HISTORY; i = i + 1)
                if (chosen_fits[i]) chosen_activation = now - 1 - i;
    end
    wire serves = found && out0_room;
    wire [`IN0_W-1:0] served = burst[place];
    wire [B-1:0] of = served[`IN0_bank +: B];
    wire writes = served[`IN0_write];
    wire [31:0] after = now + (writes ? CWL + BURST + WR : RTP), since = outcome == HIT ? free[of] : chosen_activation + RAS;
    assign start = in0_valid && waiting != QUEUE;
    assign in0_pop = start;
    assign out0_reserve = serves;
    assign out0_push = serves;
    always @* begin
        out0 = 0;
        out0[`OUT0_number +: `OUT0_number_N] = served[`IN0_number +: `IN0_number_N];
        out0[`OUT0_outcome +: 2] = outcome;
    end
    wire [7:0] left = held - {7'd0, serves};
    wire has_room = left < WINDOW, pulls = has_room && waiting != 0, joins = start && has_room && waiting == 0;
    wire refreshes = REFI != 0 && (now + 1) % (REFI == 0 ? 1 : REFI) == 0;
    always @(posedge clk)
        if (rst) begin
            now <= 0;
            held <= 0;
            passed <= 0;
            waiting <= 0;
            head <= 0;
            tail <= 0;
            open <= 0;
            history <= 0;
            for (i = 0; i < WINDOW; i = i + 1) made_room[i] <= 0;
            bus_read <= 0;
            bus_write <= 0;
            activation <= 0;
            for (i = 0; i < 4; i = i + 1) four[i] <= 0;
            for (i = 0; i < BANKS; i = i + 1) free[i] <= 0;
        end else begin
            now <= now + 1;
            history <= {history, 1'b0} | (serves ? ONE : 0) | (serves && outcome != HIT ? ONE << (now - chosen_activation) : 0)
                | (serves && outcome == CONFLICT ? ONE << (now - chosen_activation + RP) : 0);
            if (serves) begin
                made_room[0] <= now + 1;
                for (i = 1; i < WINDOW; i = i + 1) made_room[i] <= made_room[i-1];
                for (i = 0; i < WINDOW; i = i + 1)
                    if (i >= place) begin
                        burst[i] <= burst[i+1];
                        from[i] <= from[i+1];
                    end
                passed <= place == 0 ? 8'd0 : passed + 8'd1;
                bus_read <= now + (writes ? WRITE_TO_READ : BURST);
                bus_write <= now + (writes ? BURST : READ_TO_WRITE);
                free[of] <= after > since ? after : since;
                if (outcome != HIT) begin
                    open[of] <= 1'b1;
                    row[of] <= served[`IN0_row +: `IN0_row_N];
                    ready[of] <= chosen_activation + RCD;
                    activation <= chosen_activation + RRD;
                    four[0] <= chosen_activation + FAW;
                    for (i = 1; i < 4; i = i + 1) four[i] <= four[i-1];
                end
            end
            if (pulls || joins) begin
                burst[left] <= pulls ? behind[head] : in0;
                from[left] <= now + 1;
            end
            held <= left + {7'd0, pulls || joins};
            if (pulls) head <= head == QUEUE - 1 ? {Q{1'b0}} : head + 1'b1;
            if (start && !joins) begin
                behind[tail] <= in0;
                tail <= tail == QUEUE - 1 ? {Q{1'b0}} : tail + 1'b1;
            end
            waiting <= waiting + {{Q{1'b0}}, start && !joins} - {{Q{1'b0}}, pulls};
            // A refresh closes all rows and delays activations.
            if (refreshes) begin
                open <= 0;
                for (i = 0; i < BANKS; i = i + 1) free[i] <= now + 1 + RFC;
            end
        end
endmodule
`default_nettype wire
