!> Parcels that take turns in few columns of forces move as those with a column each, bit for bit.
!> ranks: 1 2
program test_force_ring
  use check, only: expect, finish
  use communicator, only: communicator_t, start_ranks, stop_ranks
  use contact_list, only: columns_at_once, stretch_rows
  use contact_settings, only: contact_settings_t
  use des_scenes, only: scene, put, cloud, run
  use kinds, only: wp
  use parcels, only: force_place
  use solids, only: solids_t
  implicit none

  integer, parameter :: side(2) = 8, layers = 190, n = layers*product(side)
  type(communicator_t) :: comm
  type(contact_settings_t) :: contact

  call start_ranks(comm)
  call places()
  call windows()
  contact%stiffness = 200.0_wp
  call in_turn(contact, 1.0_wp, 'frictionless')
  call in_turn(contact, 0.02_wp, 'tight, far between', apart=300)
  contact%friction = 0.3_wp
  call in_turn(contact, 1.0_wp, 'selected')
  call in_turn(contact, 0.02_wp, 'tight')
  contact%rolling = 'constant'
  contact%rolling_friction = 0.1_wp
  call in_turn(contact, 1.0_wp, 'rolling')
  contact%cohesion = 'van_der_waals'
  contact%hamaker_constant = 1.0e-19_wp
  contact%minimum_separation = 4.0e-10_wp
  contact%maximum_separation = 1.0e-5_wp
  call in_turn(contact, 0.1_wp, 'attracted')
  if (comm%is_root()) call finish()
  call stop_ranks()

contains

  subroutine places()
    integer :: i

    if (.not. comm%is_root()) return
    call expect(all(force_place([1, 8, 9, 16, 17], 20, 8) == [1, 8, 1, 8, 1]), 'parcels take turns')
    call expect(all(force_place([(i, i=21, 40)], 20, 8) == 0), 'ghosts share a column')
  end subroutine places

  !> Pairs (row, partner) of 3000 parcels: a window goes from the first row of the stretch to the last partner.
  subroutine windows()
    integer, parameter :: s = stretch_rows
    integer, parameter :: row(4) = [5, 900, 1100, 2100], partner(4) = [10, 1300, 3001, 2400]

    if (.not. comm%is_root()) return
    call expect(columns_at_once(row(:0), partner(:0), 3000, 1) == s, 'a stretch alone')
    call expect(columns_at_once(row, partner, 3000, 1) == 1300, 'its last partner; ghosts do not count')
    call expect(columns_at_once(row, partner, 3000, 4) == 2400, 'pairs swept with the first of four')
    call expect(columns_at_once(row(2:), partner(2:), 3001, 1) == 3001 - s, 'own parcels do')
  end subroutine windows

  subroutine in_turn(contact, share, name, apart)
    type(contact_settings_t), intent(in) :: contact
    real(wp), intent(in) :: share  !< of the longest step
    character(len=*), intent(in) :: name
    integer, intent(in), optional :: apart  !< one parcel of so many has a near one

    integer, parameter :: steps = 30
    type(solids_t) :: balls
    real(wp), allocatable :: one(:,:), other(:,:)
    logical :: as_meant
    real(wp) :: off

    balls = shaft(contact, apart)
    call run(balls, steps, share*balls%time_step_limit())
    as_meant = balls%parcels%ring < balls%parcels%n .and. (balls%pairs%tight .eqv. share < 0.5_wp)
    allocate (one, source=balls%parcels%state(:, :balls%parcels%n))
    balls = shaft(contact, apart)
    call balls%parcels%make_ring(balls%parcels%n)
    call run(balls, steps, share*balls%time_step_limit())
    as_meant = as_meant .and. balls%parcels%ring >= balls%parcels%n
    allocate (other, source=balls%parcels%state(:, :balls%parcels%n))
    as_meant = comm%max(merge(0.0_wp, 1.0_wp, as_meant)) < 0.5_wp
    off = comm%max(maxval(abs(one - other)))
    if (.not. comm%is_root()) return
    call expect(as_meant, 'few columns in one run, enough in the other: '//name)
    call expect(.not. off > 0.0_wp, 'they move alike: '//name)
  end subroutine in_turn

  !> A dense cloud in a tall shaft that is periodic upwards; or one that is thin but for some pairs.
  function shaft(contact, apart) result(balls)
    type(contact_settings_t), intent(in) :: contact
    integer, intent(in), optional :: apart
    type(solids_t) :: balls

    real(wp), allocatable :: x(:,:), v(:,:), diameter(:)
    real(wp) :: pitch
    integer :: i

    pitch = merge(2.5e-3_wp, 1.15e-3_wp, present(apart))
    call cloud(n, [0.0_wp, 0.0_wp, 0.0_wp], pitch, side, x, v, diameter)
    if (present(apart)) then
      do i = 2, n, apart
        x(:, i) = x(:, i - 1) + [0.499_wp*sum(diameter(i - 1:i)), 0.0_wp, 0.0_wp]
      end do
    end if
    balls = scene(comm, pitch*[side(1), side(2), layers], 0.0_wp, contact, periodic=[.false., .false., .true.])
    call put(balls, x, v, diameter)
  end function shaft

end program test_force_ring
