!> How deep contacts are: what is counted, which stiffness is advised, and the step of fast parcels.
!> ranks: 1 2
program test_overlaps
  use check, only: expect, expect_close, finish
  use communicator, only: communicator_t, start_ranks, stop_ranks
  use contact_settings, only: contact_settings_t
  use des_scenes, only: scene, put, run
  use kinds, only: wp
  use overlap_report, only: stiffness_factor, modulus_factor
  use solids, only: solids_t
  use solids_statistics, only: statistics_t, find_statistics
  implicit none

  type(communicator_t) :: comm
  real(wp), parameter :: d = 1.0e-3_wp

  call start_ranks(comm)
  call count_shares()
  call follow_advice()
  call limit_by_speed()
  call finish()
  call stop_ranks()

contains

  pure function linear(k) result(contact)
    real(wp), intent(in) :: k  !< [N/m]
    type(contact_settings_t) :: contact

    contact%stiffness = k
    contact%restitution = 1.0_wp
  end function linear

  pure function hertz(modulus) result(contact)
    real(wp), intent(in) :: modulus  !< [Pa]
    type(contact_settings_t) :: contact

    contact%law = 'hertz'
    contact%youngs_modulus = modulus
    contact%poisson_ratio = 0.3_wp
    contact%restitution = 1.0_wp
  end function hertz

  !> Pairs whose overlaps lie on either side of 1, 5 and 10 % of the smaller radius, and a ball in a wall.
  subroutine count_shares()
    real(wp), parameter :: radius(2) = [0.5e-3_wp, 0.4e-3_wp], depth(5) = [0.009_wp, 0.011_wp, 0.049_wp, 0.051_wp, 0.101_wp]
    real(wp) :: x(3, 11), v(3, 11), diameter(11)
    type(solids_t) :: solids
    type(statistics_t) :: s
    integer :: pair

    solids = scene(comm, [0.02_wp, 0.01_wp, 0.01_wp], 0.0_wp, linear(50.0_wp))
    v = 0.0_wp
    do pair = 1, size(depth)
      x(:, 2*pair - 1) = [0.003_wp*pair, 0.005_wp, 0.005_wp]
      x(:, 2*pair) = x(:, 2*pair - 1) + [0.0_wp, sum(radius) - depth(pair)*minval(radius), 0.0_wp]
      diameter(2*pair - 1:2*pair) = 2*radius
    end do
    x(:, 11) = [0.018_wp, 0.94_wp*radius(1), 0.005_wp]
    diameter(11) = 2*radius(1)
    call put(solids, x, v, diameter)
    s = find_statistics(solids)
    call expect(s%contacts == 5 .and. s%wall_contacts == 1, 'five pairs and a wall touch')
    call expect_close(s%max_overlap, 0.101_wp, 1.0e-9_wp, 'the deepest is known')
    call expect_close(s%mean_overlap, sum(depth)/5, 1.0e-9_wp, 'the mean is that of pairs')
    call expect_close(s%beyond(1), 5.0_wp/6, 1.0e-12_wp, 'five of six are beyond 1 %')
    call expect_close(s%beyond(2), 3.0_wp/6, 1.0e-12_wp, 'three of six are beyond 5 %')
    call expect_close(s%beyond(3), 1.0_wp/6, 1.0e-12_wp, 'one of six is beyond 10 %')
  end subroutine count_shares

  !> A head-on collision as deep as 0.3 r; with the stiffness advised for 0.1 r it is as deep as that.
  subroutine follow_advice()
    real(wp), parameter :: soft = 2.0_wp, wanted = 0.1_wp
    real(wp) :: found

    found = deepest(linear(soft))
    call expect(found > 0.2_wp, 'the soft pair overlaps much')
    call expect_close(deepest(linear(soft*stiffness_factor(found, wanted))), wanted, 2.0e-3_wp, &
                      'the stiffness advised keeps what it says')
    found = deepest(hertz(3.0e4_wp))
    call expect(found > 0.2_wp, 'so does a pair of soft material')
    call expect_close(deepest(hertz(3.0e4_wp*modulus_factor(found, wanted))), wanted, 2.0e-3_wp, &
                      'the modulus advised keeps what it says')
  end subroutine follow_advice

  !> Largest overlap of two equal parcels that meet at 1 m/s [-].
  function deepest(contact)
    type(contact_settings_t), intent(in) :: contact
    real(wp) :: deepest

    type(solids_t) :: solids
    type(statistics_t) :: s
    real(wp) :: dt
    integer :: step

    solids = scene(comm, [0.01_wp, 0.01_wp, 0.01_wp], 0.0_wp, contact)
    call put(solids, reshape([4.45_wp, 5.0_wp, 5.0_wp, 5.55_wp, 5.0_wp, 5.0_wp]*1.0e-3_wp, [3, 2]), &
             reshape([0.5_wp, 0.0_wp, 0.0_wp, -0.5_wp, 0.0_wp, 0.0_wp], [3, 2]), [d, d])
    dt = 0.2_wp*solids%time_step_limit()
    deepest = 0.0_wp
    do step = 1, 130
      call run(solids, 1, dt)
      s = find_statistics(solids)
      deepest = max(deepest, s%max_overlap)
    end do
  end function deepest

  !> Slow parcels are bound by their collision time, fast ones by a tenth of the smallest radius.
  subroutine limit_by_speed()
    type(solids_t) :: solids

    solids = scene(comm, [0.01_wp, 0.01_wp, 0.01_wp], 0.0_wp, linear(50.0_wp))
    call put(solids, reshape([2.0_wp, 5.0_wp, 5.0_wp, 8.0_wp, 5.0_wp, 5.0_wp]*1.0e-3_wp, [3, 2]), &
             reshape([0.1_wp, 0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp], [3, 2]), [d, 2*d])
    call expect_close(solids%next_step_limit(), solids%time_step_limit(), 1.0e-12_wp, 'a slow parcel needs no shorter step')
    solids = scene(comm, [0.01_wp, 0.01_wp, 0.01_wp], 0.0_wp, linear(50.0_wp))
    call put(solids, reshape([2.0_wp, 5.0_wp, 5.0_wp, 8.0_wp, 5.0_wp, 5.0_wp]*1.0e-3_wp, [3, 2]), &
             reshape([3.0_wp, 4.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp], [3, 2]), [2*d, d])
    call expect_close(solids%next_step_limit(), 0.1_wp*0.5_wp*d/5.0_wp, 1.0e-12_wp, 'a fast parcel moves a tenth of it')
  end subroutine limit_by_speed

end program test_overlaps
