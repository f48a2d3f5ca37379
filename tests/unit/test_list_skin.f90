!> How far beyond contact pairs are listed: as in a bed where parcels are many, twice as far where they are few.
!> ranks: 1 2
program test_list_skin
  use chamber, only: chamber_t
  use check, only: expect, expect_close, finish
  use communicator, only: communicator_t, start_ranks, stop_ranks
  use contact_settings, only: contact_settings_t
  use des_scenes, only: scene, put, cloud, run
  use kinds, only: wp
  use list_skin, only: fitting_skin, skin_within
  use outcome, only: outcome_t
  use solids, only: solids_t
  use solids_state, only: solids_state_t, export_state, import_state
  implicit none

  real(wp), parameter :: d = 1.0e-3_wp
  type(communicator_t) :: comm

  call start_ranks(comm)
  if (comm%is_root()) then
    call fitting()
    call within()
  end if
  call of_cloud(pitch=0.95e-3_wp, periodic=.false., skin=[0.4_wp, 0.5_wp], name='dense')
  call of_cloud(pitch=3.0e-3_wp, periodic=.false., skin=[0.799_wp, 0.801_wp], name='dilute')
  call of_cloud(pitch=3.0e-3_wp, periodic=.true., skin=[0.5_wp, 0.7_wp], name='dilute, hardly three ranges long')
  if (comm%is_root()) call finish()
  call stop_ranks()

contains

  !> Pairs go with the cube of the distance.
  subroutine fitting()
    call expect_close(fitting_skin(0.4e-3_wp, d, 6.0_wp), 0.4e-3_wp, 1.0e-15_wp, 'as many pairs as usual: the same skin [m]')
    call expect_close(fitting_skin(0.4e-3_wp, d, 6.0_wp*(1.4_wp/1.7_wp)**3), 0.7e-3_wp, 1.0e-15_wp, 'fewer: a wider one [m]')
    call expect(fitting_skin(0.4e-3_wp, d, 0.0_wp) > d, 'none: as wide as may be')
  end subroutine fitting

  subroutine within()
    type(chamber_t) :: chamber

    chamber%upper = [4.0e-3_wp, 5.0e-3_wp, 1.0_wp]
    call expect_close(skin_within(chamber, d, d, 1.0_wp), 0.8e-3_wp, 1.0e-15_wp, 'the widest [m]')
    call expect_close(skin_within(chamber, d, d, 0.0_wp), 0.4e-3_wp, 1.0e-15_wp, 'the narrowest [m]')
    chamber%periodic(2) = .true.
    call expect_close(skin_within(chamber, d, d, 1.0_wp), 5.0e-3_wp/3 - d, 1.0e-15_wp, 'in a short period [m]')
    chamber%periodic(1) = .true.
    call expect_close(skin_within(chamber, d, d, 0.0_wp), 4.0e-3_wp/3 - d, 1.0e-15_wp, 'narrower than that in a shorter one [m]')
    chamber%upper(1) = 3.2e-3_wp
    call expect_close(skin_within(chamber, d, d, 1.0_wp), 0.1e-3_wp, 1.0e-15_wp, 'in one too short [m]')
  end subroutine within

  !> The second lists, and those of a run that goes on from a restart.
  subroutine of_cloud(pitch, periodic, skin, name)
    real(wp), intent(in) :: pitch    !< [m]
    logical, intent(in) :: periodic  !< along y, on six balls
    real(wp), intent(in) :: skin(2)  !< in between, over d
    character(len=*), intent(in) :: name

    integer, parameter :: side(2) = [10, 10]
    type(solids_t) :: balls, again
    type(solids_state_t) :: state
    type(contact_settings_t) :: contact
    type(outcome_t) :: outcome
    real(wp), allocatable :: x(:,:), v(:,:), diameter(:)
    real(wp) :: extent(3)
    integer :: n

    contact%stiffness = 200.0_wp
    n = 1000
    extent = pitch*10
    if (periodic) extent(2) = 3*1.6_wp*d
    call cloud(n, [0.0_wp, 0.0_wp, 0.0_wp], pitch, side, x, v, diameter)
    diameter = d
    if (periodic) then
      n = 20
      x(:, :n) = x(:, 1:10*n:10)
      x(2, :n) = 0.5_wp*extent(2)
    end if
    balls = scene(comm, extent, 0.0_wp, contact, periodic=[.false., periodic, .false.])
    call put(balls, x(:, :n), v(:, :n), diameter(:n))
    if (comm%is_root()) call expect_close(balls%skin, 0.4_wp*d, 1.0e-15_wp, 'the first lists [m], '//name)
    call balls%renew_lists(outcome)
    if (comm%is_root()) then
      call expect(balls%skin >= skin(1)*d*(1 - 1e-12_wp) .and. balls%skin <= skin(2)*d, 'the second lists, '//name)
      call expect_close(balls%range, d + balls%skin, 1.0e-15_wp, 'pairs are listed as far [m], '//name)
      call expect(all(balls%tiles%width >= balls%range .or. balls%tiles%n == 1), 'and tiles are as wide, '//name)
    end if
    call run(balls, 5, balls%time_step_limit())
    call export_state(balls, state)
    again = scene(comm, extent, 0.0_wp, contact, periodic=[.false., periodic, .false.])
    call import_state(again, state, outcome)
    if (comm%is_root()) call expect(.not. outcome%failed() .and. abs(again%skin - balls%skin) <= 0.0_wp, &
                                    'a restart lists them as far, '//name)
  end subroutine of_cloud

end program test_list_skin
