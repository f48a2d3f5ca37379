!> Speed of the contact loop in beds of its own making: k_n = 200 N/m, e = 0.9, mu = 0.1, dt = t_c/50.
!>
!>   W1  settled bed of 50 000 spheres of 1 mm on a base of 50 x 50 mm, shaken so that lists are made about every 200 steps
!>   W2  the same of 200 000, on 100 x 100 mm
!>   W3  the same of 50 000, log-normal by number between 0.5 and 2 mm
!>   W4  granular gas of 50 000 spheres of 1 mm, solids 0.05, in a box with walls
!>   wide  50 000 of diameters from 1 to 10, each factor between with the same volume, that fill as much as those of W1; packed,
!>         then settled with little friction, so that they have as many contacts; in turn with W1
!>   frictionless, hertz, rolling, cohesion  W1 with other laws; still: W1 of springs alone
!>
!> usage: bench_contacts [folder [workload [steps]]]. All workloads if none is named, W2 on more than one rank. Beds are kept in
!> `folder`, if one is given, and taken from there. With 0 steps: where the parcels are after 100, into the folder.
!>
!> ranks: 1 2
program bench_contacts
  use chamber, only: chamber_t
  use communicator, only: communicator_t, start_ranks, stop_ranks
  use constants, only: pi
  use contact_settings, only: contact_settings_t
  use des_settings, only: des_settings_t
  use, intrinsic :: iso_fortran_env, only: int64
  use kinds, only: wp, i8
  use outcome, only: outcome_t
  use powders, only: equal_volumes, log_normal, packed
  use solids, only: solids_t
  implicit none

  !> A workload: parcels in their box.
  type :: bed_t
    character(len=16) :: name = ' '
    integer :: n = 50000
    real(wp) :: box(3) = [0.05_wp, 0.05_wp, 0.08_wp]  !< [m]
    logical :: gas = .false.                          !< a granular gas, else a settled bed
    real(wp), allocatable :: x(:,:)                   !< (3,n) [m]
    real(wp), allocatable :: diameter(:)              !< (n) [m]
    type(contact_settings_t) :: contact
  end type bed_t

  !> A workload on its way.
  type :: run_t
    type(bed_t) :: bed
    type(solids_t) :: solids
    real(wp) :: dt = 0.0_wp                   !< [s]
    integer :: blocks = 0                     !< done
    real(wp) :: contacts = 0.0_wp             !< per parcel, sum over blocks
    real(wp) :: last = 0.0_wp                 !< wall time of the last block [s]
    real(wp) :: making = 0.0_wp, total = 0.0_wp  !< of making lists, of all [s]
  end type run_t

  integer, parameter :: block = 200           !< steps
  real(wp), parameter :: density = 2500.0_wp, weight_of_gravity = 9.81_wp
  character(len=16), parameter :: all_names(10) = [character(len=16) :: 'W1', 'W2', 'W3', 'W4', 'wide', 'frictionless', &
    'hertz', 'rolling', 'cohesion', 'still']
  type(communicator_t) :: comm
  character(len=16) :: name
  character(len=256) :: folder
  integer :: i, steps

  call start_ranks(comm)
  call get_command_argument(1, folder)
  call get_command_argument(2, name)
  if (comm%size > 1 .and. name == ' ') name = 'W2'
  steps = nint(number(3, 1000.0_wp))
  do i = 1, size(all_names)
    if ((name == ' ' .and. all_names(i) /= 'still') .or. name == all_names(i)) call measure(all_names(i))
  end do
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

  subroutine measure(workload)
    character(len=*), intent(in) :: workload

    type(bed_t) :: bed

    call make(workload, bed)
    select case (workload)
    case ('wide')
      call time_in_turn(bed)
      return
    case ('frictionless')
      bed%contact%friction = 0.0_wp
    case ('still')
      bed%contact%friction = 0.0_wp
      bed%contact%restitution = 1.0_wp
    case ('rolling')
      bed%contact%rolling = 'spring'
      bed%contact%rolling_friction = 0.05_wp
    case ('cohesion')
      bed%contact%cohesion = 'van_der_waals'
      bed%contact%hamaker_constant = 1.0e-19_wp
      bed%contact%minimum_separation = 4.0e-10_wp
      bed%contact%maximum_separation = 1.0e-6_wp
    case ('hertz')
      bed%contact%law = 'hertz'
      bed%contact%youngs_modulus = 5.0e6_wp
      bed%contact%poisson_ratio = 0.25_wp
      bed%contact%impact_velocity = 0.1_wp
    case default
    end select
    if (steps > 0) then
      call time_loop(bed)
    else
      call follow(bed)
    end if
  end subroutine measure

  !> Parcels on a loose lattice.
  function new_bed(workload) result(bed)
    character(len=*), intent(in) :: workload
    type(bed_t) :: bed

    real(wp) :: pitch
    integer :: k, side(2)

    bed%name = workload
    bed%contact%stiffness = 200.0_wp
    bed%contact%friction = 0.1_wp
    pitch = 0.05_wp/43
    select case (workload)
    case ('W2')
      bed%n = 200000
      bed%box = [0.1_wp, 0.1_wp, 0.08_wp]
    case ('W3')
      pitch = 0.05_wp/22
      bed%box(3) = 0.3_wp
    case ('W4')
      bed%gas = .true.
      bed%box = (bed%n*pi/6*1.0e-9_wp/0.05_wp)**(1.0_wp/3.0_wp)
      pitch = bed%box(1)/37
    case default
      continue
    end select
    side = int(bed%box(1:2)/pitch*(1 + 1e-9_wp))
    allocate (bed%x(3, bed%n), bed%diameter(bed%n))
    do k = 1, bed%n
      bed%x(:, k) = pitch*([modulo(k - 1, side(1)), modulo((k - 1)/side(1), side(2)), (k - 1)/product(side)] + 0.5_wp)
      bed%x(:, k) = bed%x(:, k) + 0.07e-3_wp*sin(k*[12.9898_wp, 78.233_wp, 37.719_wp])
      bed%diameter(k) = 1.0e-3_wp
      if (workload == 'W3') bed%diameter(k) = log_normal(modulo(k*0.6180339887498949_wp, 1.0_wp))
    end do
    if (workload == 'wide') then
      bed%diameter = equal_volumes(bed%n, 10.0_wp)
      bed%contact%friction = 0.03_wp
    end if
  end function new_bed

  !> A bed at rest or the gas, from its file or made.
  recursive subroutine make(workload, bed)
    character(len=*), intent(in) :: workload
    type(bed_t), intent(out) :: bed

    type(bed_t) :: part
    integer :: unit, status
    character(len=300) :: file, message

    bed = new_bed(workload)
    file = trim(folder)//'/'//trim(name_of_bed(workload))//'.bed'
    open (newunit=unit, file=file, access='stream', form='unformatted', status='old', action='read', iostat=status, iomsg=message)
    if (len_trim(folder) > 0 .and. status == 0) then
      read (unit) bed%x, bed%diameter
      close (unit)
      return
    end if
    if (workload == 'W2') then
      call make('W1', part)
      bed%x = mirrored(mirrored(part%x, 1, part%box(1)), 2, part%box(2))
      call settle(bed, stiffness=200.0_wp, time=0.01_wp)
    else if (.not. bed%gas) then
      if (workload == 'wide') bed%x = packed(bed%diameter, bed%box)
      if (workload == 'W3') then
        call settle(bed, stiffness=60.0_wp, time=0.12_wp, pull=5.0_wp)
      else
        call settle(bed, stiffness=20.0_wp, time=merge(0.12_wp, 0.2_wp, workload == 'wide'))
      end if
      call settle(bed, stiffness=60.0_wp, time=0.02_wp)
      call settle(bed, stiffness=200.0_wp, time=0.04_wp)
    end if
    if (len_trim(folder) == 0 .or. .not. comm%is_root()) return
    open (newunit=unit, file=file, access='stream', form='unformatted', status='replace', action='write')
    write (unit) bed%x, bed%diameter
    close (unit)
  end subroutine make

  !> Where a workload has no bed of its own, that of W1.
  pure function name_of_bed(workload) result(name)
    character(len=*), intent(in) :: workload
    character(len=16) :: name

    name = workload
    if (all(workload /= [character(len=16) :: 'W2', 'W3', 'W4', 'wide'])) name = 'W1'
  end function name_of_bed

  !> Places and their images behind a wall at the far end of an axis.
  pure function mirrored(x, axis, wall) result(both)
    real(wp), intent(in) :: x(:,:)  !< (3,n) [m]
    integer, intent(in) :: axis
    real(wp), intent(in) :: wall    !< [m]
    real(wp) :: both(3, 2*size(x, 2))

    integer :: n

    n = size(x, 2)
    both(:, 1:n) = x
    both(:, n + 1:) = x
    both(axis, n + 1:) = 2*wall - x(axis, :)
  end function mirrored

  subroutine start(bed, contact, solids)
    type(bed_t), intent(in) :: bed
    type(contact_settings_t), intent(in) :: contact
    type(solids_t), intent(out) :: solids

    type(chamber_t) :: chamber
    real(wp) :: v(3, bed%n)
    integer :: k, n

    chamber%lower = 0.0_wp
    chamber%upper = bed%box
    v = 0.0_wp
    if (bed%gas) then
      v = reshape([(0.5_wp*sin(k*0.7548776662466927_wp*k), k=1, size(v))], shape(v))
    else
      chamber%gravity = [0.0_wp, 0.0_wp, -weight_of_gravity]
    end if
    call solids%create(comm, chamber, contact, des_settings_t(), .false., 0.0_wp)
    n = merge(bed%n, 0, comm%is_root())
    call solids%add(bed%x(:, 1:n), v(:, 1:n), bed%diameter(1:n), spread(1.0_wp, 1, n), spread(density, 1, n), &
                    spread(1, 1, n), [(int(k, i8), k=1, n)])
  end subroutine start

  !> Let the parcels fall for a time, with little restitution; softer ones fall in fewer steps, a stronger gravity in less time.
  subroutine settle(bed, stiffness, time, pull)
    type(bed_t), intent(inout) :: bed
    real(wp), intent(in) :: stiffness, time  !< [N/m], [s]
    real(wp), intent(in), optional :: pull   !< over gravity [-]

    type(solids_t) :: solids
    type(contact_settings_t) :: contact
    type(outcome_t) :: outcome
    real(wp) :: dt
    integer :: k

    contact = bed%contact
    contact%stiffness = stiffness
    contact%restitution = 0.3_wp
    call start(bed, contact, solids)
    if (present(pull)) solids%chamber%gravity = pull*solids%chamber%gravity
    dt = solids%time_step_limit()
    call solids%advance(nint(time/dt), dt, outcome)
    if (outcome%failed()) call fail(outcome)
    bed%x = 0.0_wp
    do k = 1, solids%parcels%n
      bed%x(:, solids%parcels%id(k)) = solids%parcels%state(1:3, k)
    end do
    do k = 1, 3
      bed%x(k, :) = comm%sum(bed%x(k, :))
    end do
    if (comm%is_root()) print '(2a,f8.4,a,es9.2)', bed%name, 'settled to a height of ', maxval(bed%x(3, :)), &
      ' m, largest speed [m/s] ', sqrt(maxval(sum(solids%parcels%state(5:7, 1:solids%parcels%n)**2, 1)))
  end subroutine settle

  !> The loop in blocks of 200 steps, each followed by new lists.
  subroutine time_loop(bed)
    type(bed_t), intent(in) :: bed

    type(run_t) :: run
    integer :: k

    call warm_up(bed, run)
    do k = 1, max(1, steps/block)
      call go_on(run)
    end do
    call report_run(run)
  end subroutine time_loop

  !> Block after block in turn with W1. The cost of a parcel and step over that of W1 is the median of the ratios of blocks.
  subroutine time_in_turn(bed)
    type(bed_t), intent(in) :: bed

    type(bed_t) :: equals
    type(run_t) :: run, single
    real(wp) :: ratio(max(1, steps/block))
    integer :: k

    call make('W1', equals)
    call warm_up(bed, run)
    call warm_up(equals, single)
    do k = 1, size(ratio)
      call go_on(run)
      call go_on(single)
      ratio(k) = (run%last/bed%n)/(single%last/equals%n)
    end do
    call report_run(run)
    call report(bed, 'W1_contacts', single%contacts/single%blocks, 'per_parcel')
    call report(bed, 'cost', median(ratio), 'of_W1')
  end subroutine time_in_turn

  subroutine warm_up(bed, run)
    type(bed_t), intent(in) :: bed
    type(run_t), intent(out) :: run

    type(outcome_t) :: outcome

    run%bed = bed
    call start(bed, bed%contact, run%solids)
    run%dt = 0.4_wp*run%solids%time_step_limit()
    call run%solids%advance(merge(3000, 100, bed%gas), run%dt, outcome)
    if (outcome%failed()) call fail(outcome)
  end subroutine warm_up

  !> A block of steps and the making of lists, timed apart.
  subroutine go_on(run)
    type(run_t), intent(inout) :: run

    integer, parameter :: part = 20
    type(outcome_t) :: outcome
    integer :: k
    real(wp) :: begin, between, end

    begin = clock()
    do k = 1, block/part
      if (.not. run%bed%gas) run%solids%chamber%gravity(3) = -weight_of_gravity*(1 + 0.5_wp*sin(2*pi*50*run%solids%time))
      call run%solids%advance(part, run%dt, outcome)
    end do
    between = clock()
    call run%solids%renew_lists(outcome)
    end = clock()
    if (outcome%failed()) call fail(outcome)
    run%contacts = run%contacts + 2*comm%sum(touching(run%solids))/run%bed%n
    run%last = end - begin
    run%making = run%making + end - between
    run%total = run%total + run%last
    run%blocks = run%blocks + 1
  end subroutine go_on

  subroutine report_run(run)
    type(run_t), intent(in) :: run

    associate (bed => run%bed, solids => run%solids)
      call report(bed, 'rate', real(bed%n, wp)*block*run%blocks/run%total, 'parcel-steps/s')
      call report(bed, 'list', run%making/bed%n/run%blocks*1e6_wp, 'us/parcel')
      call report(bed, 'memory', comm%sum(real(bytes(solids), wp))/bed%n, 'bytes/parcel')
      call report(bed, 'ghost', 8*real(size(solids%parcels%state, 1), wp), 'bytes/step')
      call report(bed, 'contacts', run%contacts/run%blocks, 'per_parcel')
    end associate
  end subroutine report_run

  !> Places after 100 steps from rest, by id, into the folder.
  subroutine follow(bed)
    type(bed_t), intent(inout) :: bed

    type(solids_t) :: solids
    type(outcome_t) :: outcome
    integer :: unit, k

    call start(bed, bed%contact, solids)
    call solids%advance(100, 0.4_wp*solids%time_step_limit(), outcome)
    do k = 1, bed%n
      bed%x(:, solids%parcels%id(k)) = solids%parcels%state(1:3, k)
    end do
    open (newunit=unit, file=trim(folder)//'/'//trim(bed%name)//'.after', access='stream', form='unformatted', &
          status='replace', action='write')
    write (unit) bed%x
    close (unit)
  end subroutine follow

  subroutine fail(outcome)
    type(outcome_t), intent(in) :: outcome

    print '(a)', outcome%message
    error stop 3
  end subroutine fail

  subroutine report(bed, quantity, value, unit)
    type(bed_t), intent(in) :: bed
    character(len=*), intent(in) :: quantity, unit
    real(wp), intent(in) :: value

    if (comm%is_root()) print '(5a,es12.4,2a)', 'bench contacts_', trim(bed%name), '_', quantity, ' ', value, ' ', unit
  end subroutine report

  !> Pairs in contact; half of each that is seen from two ranks.
  pure function touching(solids) result(contacts)
    type(solids_t), intent(in) :: solids
    real(wp) :: contacts

    integer :: k

    contacts = 0
    do k = 1, solids%list%entries
      associate (a => solids%parcels%state(1:4, solids%list%row(k)), b => solids%parcels%state(1:4, solids%list%partner(k)))
        if (norm2(a(1:3) - b(1:3)) < a(4) + b(4)) contacts = contacts &
                                                             + merge(1.0_wp, 0.5_wp, solids%list%partner(k) <= solids%parcels%n)
      end associate
    end do
  end function touching

  pure function median(values)
    real(wp), intent(in) :: values(:)
    real(wp) :: median

    real(wp) :: rank(size(values))
    integer :: k

    ! The value below which half of the others lie, equals counted half.
    do k = 1, size(values)
      rank(k) = count(values < values(k)) + 0.5_wp*count(values <= values(k) .and. values >= values(k))
    end do
    median = values(minloc(abs(rank - 0.5_wp*size(values)), 1))
  end function median

  !> [s]
  function clock() result(now)
    real(wp) :: now

    integer(int64) :: count, rate

    call system_clock(count, rate)
    now = real(count, wp)/rate
  end function clock

  !> What the loop keeps of its parcels and pairs [bytes].
  pure function bytes(solids)
    type(solids_t), intent(in) :: solids
    integer(int64) :: bytes

    associate (p => solids%parcels, pairs => solids%pairs)
      bytes = p%n*(8_int64*(size(p%state, 1) + size(p%aside, 1) + 3 + 2 + 1) + 4) + 8_int64*size(p%force) &
              + solids%list%entries*8_int64 + pairs%n*12_int64
      if (allocated(pairs%record)) bytes = bytes + 8_int64*size(pairs%record)
      if (allocated(pairs%place)) bytes = bytes + 4_int64*size(pairs%place) + 8_int64*(size(pairs%memory) + size(pairs%before))
    end associate
  end function bytes

end program bench_contacts
