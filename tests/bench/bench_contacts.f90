!> Speed of the contact loop on a settled bed: 50 000 spheres of 1 mm on a base of 50 x 50 mm, k_n = 200 N/m,
!> e = 0.9, mu = 0.1, dt = t_c/50, shaken so that the lists are made anew about every 200 steps.
!>
!> usage: bench_contacts [steps] [friction] [file]. The settled bed is kept in `file` and taken from it if there.
program bench_contacts
  use chamber, only: chamber_t
  use communicator, only: communicator_t, start_ranks, stop_ranks
  use constants, only: pi
  use contact_settings, only: contact_settings_t
  use des_settings, only: des_settings_t
  use, intrinsic :: iso_fortran_env, only: int64
  use kinds, only: wp, i8
  use outcome, only: outcome_t
  use solids, only: solids_t
  implicit none

  integer, parameter :: n = 50000
  real(wp), parameter :: diameter = 1.0e-3_wp, density = 2500.0_wp, base = 0.05_wp, height = 0.08_wp
  type(communicator_t) :: comm
  real(wp) :: position(3, n), friction
  integer :: steps
  character(len=256) :: file

  call start_ranks(comm)
  steps = nint(number(1, 2000.0_wp))
  friction = number(2, 0.1_wp)
  call get_command_argument(3, file)
  call settled_bed(position)
  call time_loop(position)
  call stop_ranks()

contains

  function number(place, default)
    integer, intent(in) :: place
    real(wp), intent(in) :: default
    real(wp) :: number

    character(len=32) :: text

    call get_command_argument(place, text)
    number = default
    if (len_trim(text) > 0) read (text, *) number
  end function number

  !> Positions of the bed at rest, from the file or from a fall of a loose lattice.
  subroutine settled_bed(x)
    real(wp), intent(out) :: x(3, n)

    integer :: unit, status, i
    character(len=80) :: message

    open (newunit=unit, file=file, access='stream', form='unformatted', status='old', action='read', iostat=status, iomsg=message)
    if (len_trim(file) > 0 .and. status == 0) then
      read (unit) x
      close (unit)
      return
    end if
    x = reshape([(lattice(i), i=1, n)], [3, n])
    call settle(x, stiffness=20.0_wp, time=0.12_wp)
    call settle(x, stiffness=60.0_wp, time=0.02_wp)
    call settle(x, stiffness=200.0_wp, time=0.04_wp)
    if (len_trim(file) == 0) return
    open (newunit=unit, file=file, access='stream', form='unformatted', status='replace', action='write')
    write (unit) x
    close (unit)
  end subroutine settled_bed

  !> Place i of a jittered cubic lattice [m].
  pure function lattice(i) result(x)
    integer, intent(in) :: i
    real(wp) :: x(3)

    integer, parameter :: side = 43
    real(wp), parameter :: pitch = base/side

    x = pitch*([modulo(i - 1, side), modulo((i - 1)/side, side), (i - 1)/side**2] + 0.5_wp)
    x = x + 0.07e-3_wp*sin(i*[12.9898_wp, 78.233_wp, 37.719_wp])
  end function lattice

  subroutine new_bed(bed, x, stiffness, restitution)
    type(solids_t), intent(out) :: bed
    real(wp), intent(in) :: x(3*n), stiffness, restitution

    type(chamber_t) :: chamber
    type(contact_settings_t) :: contact
    integer :: i

    chamber%lower = 0.0_wp
    chamber%upper = [base, base, height]
    chamber%gravity = [0.0_wp, 0.0_wp, -9.81_wp]
    contact%stiffness = stiffness
    contact%restitution = restitution
    contact%friction = friction
    call bed%create(comm, chamber, contact, des_settings_t(), .false., 0.0_wp)
    if (comm%is_root()) then
      call bed%add(reshape(x, [3, n]), spread([0.0_wp, 0.0_wp, 0.0_wp], 2, n), spread(diameter, 1, n), &
                   spread(1.0_wp, 1, n), spread(density, 1, n), spread(1, 1, n), [(int(i, i8), i=1, n)])
    else
      call bed%add(reshape([real(wp) ::], [3, 0]), reshape([real(wp) ::], [3, 0]), [real(wp) ::], [real(wp) ::], &
                   [real(wp) ::], [integer ::], [integer(i8) ::])
    end if
  end subroutine new_bed

  !> Let the parcels fall for a time, with little restitution; softer ones fall in fewer steps.
  subroutine settle(x, stiffness, time)
    real(wp), intent(inout) :: x(3, n)
    real(wp), intent(in) :: stiffness, time  !< [N/m], [s]

    type(solids_t) :: bed
    type(outcome_t) :: outcome
    real(wp) :: dt
    integer :: i

    call new_bed(bed, reshape(x, [3*n]), stiffness, restitution=0.3_wp)
    dt = bed%time_step_limit()
    call bed%advance(nint(time/dt), dt, outcome)
    if (outcome%failed()) print '(a)', outcome%message
    x = 0.0_wp
    do i = 1, bed%parcels%n
      x(:, bed%parcels%id(i)) = bed%parcels%state(1:3, i)
    end do
    do i = 1, 3
      x(i, :) = comm%sum(x(i, :))
    end do
    if (comm%is_root()) print '(a,f8.4,a,es9.2)', 'settled to a height of ', maxval(x(3, :)), &
      ' m, largest speed [m/s] ', sqrt(maxval(sum(bed%parcels%state(5:7, 1:bed%parcels%n)**2, 1)))
  end subroutine settle

  !> The loop in blocks of 200 steps, each followed by new lists; the two timed apart.
  subroutine time_loop(x)
    real(wp), intent(in) :: x(3, n)

    integer, parameter :: block = 200, part = 20
    type(solids_t) :: bed
    type(outcome_t) :: outcome
    integer :: k, made
    logical :: changed
    real(wp) :: dt, stepping(2), making(2), before(2)

    call new_bed(bed, reshape(x, [3*n]), stiffness=200.0_wp, restitution=0.9_wp)
    dt = 0.4_wp*bed%time_step_limit()
    call bed%advance(100, dt, outcome)
    call bed%rebalance(changed, outcome)
    stepping = 0
    making = 0
    do made = 1, max(1, steps/block)
      before = clocks()
      do k = 1, block/part
        bed%chamber%gravity(3) = -9.81_wp*(1 + 0.5_wp*sin(2*pi*50*bed%time))
        call bed%advance(part, dt, outcome)
      end do
      stepping = stepping + clocks() - before
      before = clocks()
      call bed%renew_lists(outcome)
      making = making + clocks() - before
    end do
    if (outcome%failed()) print '(a)', outcome%message
    if (.not. comm%is_root()) return
    made = max(1, steps/block)
    print '(a,i0,2(a,f6.3),a,f6.1)', 'steps ', made*block, '  pairs listed per parcel ', &
      real(bed%list%entries, wp)/bed%parcels%n, '  close ', real(bed%pairs%n, wp)/bed%parcels%n, &
      '  bytes per parcel ', real(bytes(bed), wp)/bed%parcels%n
    print '(a,2(f7.3,a))', 'new lists  ', making(1)/n/made*1e6_wp, ' us per parcel, ', &
      making(2)/n/made*1e6_wp, ' by processor time'
    print '(a,2(f7.3,a))', 'with lists ', n*1e-6_wp*made*block/(stepping(1) + making(1)), ' M parcel-steps/s, ', &
      n*1e-6_wp*made*block/(stepping(2) + making(2)), ' by processor time'
    print '(a,es12.4,a)', 'bench contacts_rate ', n*made*block/(stepping(1) + making(1)), ' parcel-steps/s'
    print '(a,es12.4,a)', 'bench contacts_list ', making(1)/n/made*1e6_wp, ' us/parcel'
    print '(a,es12.4,a)', 'bench contacts_memory ', real(bytes(bed), wp)/bed%parcels%n, ' bytes/parcel'
  end subroutine time_loop

  !> Time on the wall and of the processor [s].
  function clocks() result(now)
    real(wp) :: now(2)

    integer(int64) :: count, rate

    call system_clock(count, rate)
    now(1) = real(count, wp)/rate
    call cpu_time(now(2))
  end function clocks

  !> What the loop keeps of its parcels and pairs [bytes].
  pure function bytes(bed)
    type(solids_t), intent(in) :: bed
    integer(int64) :: bytes

    associate (p => bed%parcels)
      bytes = p%n*(8_int64*(size(p%state, 1) + size(p%force, 1) + size(p%aside, 1) + 3 + 2 + 1) + 4) &
              + bed%list%entries*8_int64 + bed%pairs%n*(12_int64 + merge(32, 0, p%rotation))
    end associate
  end function bytes

end program bench_contacts
