!> Drag laws: against the values of other programs, and what beds do that are made of nothing else.
program verify_drag
  use communicator, only: communicator_t, start_ranks, stop_ranks
  use check, only: finish
  use drag_law, only: drag_law_t, new_drag_law
  use kinds, only: wp
  use report, only: check_value
  use sizes_beetstra, only: among_sizes_beetstra
  use sizes_cello, only: among_sizes_cello
  use sizes_yin_sundaresan, only: among_sizes_yin_sundaresan
  use uniform_beds, only: carried_velocity, packed_gradient, settling_velocity
  implicit none

  real(wp), parameter :: reynolds(6) = [0.1_wp, 1.0_wp, 10.0_wp, 30.0_wp, 100.0_wp, 500.0_wp]
  real(wp), parameter :: eps(6) = [0.95_wp, 0.85_wp, 0.60_wp, 0.45_wp, 0.75_wp, 0.40_wp]
  type(communicator_t) :: comm

  call start_ranks(comm)
  call laws_of_mfix()
  call laws_of_others()
  call laws_among_sizes()
  call fluidization()
  call packed_bed()
  call settling()
  call finish()
  call stop_ranks()

contains

  !> Values that agree with MFIX 25.2.1 (drag_gs.f): to 1e-14, syamlal_obrien, tang and tenneti (its bracket) to 5e-16; ergun is the
  !> part of gidaspow at eps <= 0.8. di_felice_sn: to 6e-8, where MFIX has constants of single precision.
  subroutine laws_of_mfix()
    call compare('wen_yu', [1.2430809516_wp, 2.0812236938_wp, 11.160825724_wp, 47.059136437_wp, 12.999625034_wp, 332.26907944_wp])
    call compare('ergun', [0.47245306248_wp, 1.8646674356_wp, 11.959876543_wp, 37.037037037_wp, 20.987654321_wp, 335.06944444_wp])
    call compare('gidaspow', [1.2430809516_wp, 2.0812236938_wp, 11.959876543_wp, 37.037037037_wp, 20.987654321_wp, &
                              335.06944444_wp])
    call compare('gidaspow_blend', [1.2368524879_wp, 2.0759818593_wp, 11.955032448_wp, 37.071758205_wp, 20.794300743_wp, &
                                    335.06095533_wp])
    call compare('syamlal_obrien', [1.3013758156_wp, 2.6075994654_wp, 10.355170567_wp, 32.958905368_wp, 16.784777226_wp, &
                                    415.78537443_wp])
    call compare('tang', [1.8120276846_wp, 3.4956187804_wp, 14.792779585_wp, 42.448452365_wp, 14.231102304_wp, 154.82812600_wp])
    call compare('tenneti', [1.6703480111_wp, 3.2159442447_wp, 13.303820023_wp, 35.957600775_wp, 12.519012300_wp, &
                             177.99215614_wp])
    call compare('di_felice_sn', [1.2444488182_wp, 2.0274656607_wp, 8.5414425038_wp, 29.149455609_wp, 11.181756514_wp, &
                                  260.21208036_wp])
  end subroutine laws_of_mfix

  !> Values that agree with CFDEMcoupling-PFM (beetstra, koch_hill) and with PhasicFlowPlus (di_felice, rong) to the last digit;
  !> cello is PhasicFlowPlus's with the -1 that it lacks.
  subroutine laws_of_others()
    call compare('beetstra', [1.7648954538_wp, 3.2804797786_wp, 13.464258242_wp, 39.509187022_wp, 15.933314894_wp, &
                              264.23076677_wp])
    call compare('koch_hill', [1.8466980350_wp, 3.3618234358_wp, 12.462472840_wp, 36.888330030_wp, 13.418002297_wp, &
                               283.51250000_wp])
    call compare('di_felice', [1.2571304098_wp, 2.1659283427_wp, 9.4928580501_wp, 32.398591427_wp, 12.619446595_wp, &
                               329.94668886_wp])
    call compare('rong', [1.3519560100_wp, 2.4941373908_wp, 9.9750098383_wp, 33.402466910_wp, 13.302528565_wp, 336.87249527_wp])
    call compare('cello', [1.8848891492_wp, 3.5138889988_wp, 13.323351265_wp, 38.766274046_wp, 15.302329395_wp, 270.06135149_wp])
  end subroutine laws_of_others

  !> The largest relative error of a law [%].
  subroutine compare(name, expected)
    character(len=*), intent(in) :: name
    real(wp), intent(in) :: expected(6)

    type(drag_law_t) :: law
    real(wp) :: value(6)

    law = new_drag_law(name)
    call law%find_factors(reynolds, eps, value)
    call check_value('drag_'//name, 100*maxval(abs(value/expected - 1)), 0.0_wp)
  end subroutine compare

  !> Two sizes, d2/d1 = 2, of half the solids' volume each: y = 0.75 and 1.5, sum of x y = 1.125. The values expected were computed
  !> outside the program from the factors of CFDEMcoupling-PFM, MFIX (HYS_drag.pdf) and PhasicFlowPlus.
  subroutine laws_among_sizes()
    real(wp), parameter :: y(6, 2) = reshape([spread(0.75_wp, 1, 6), spread(1.5_wp, 1, 6)], [6, 2])
    real(wp) :: bvk(6), value(6), expected(6, 2), error(3)
    type(drag_law_t) :: law
    integer :: i

    law = new_drag_law('beetstra')
    call law%find_factors(reynolds, eps, bvk)
    expected(:, 1) = [1.3713237676_wp, 2.5489327880_wp, 10.461728654_wp, 30.698638316_wp, 12.380185672_wp, 205.30730578_wp]
    expected(:, 2) = [3.0285605987_wp, 5.6293033001_wp, 23.104667143_wp, 67.797764930_wp, 27.341568358_wp, 453.41999577_wp]
    error(1) = maxval([(abs(among_sizes_beetstra(bvk, y(:, i))/expected(:, i) - 1), i=1, 2)])
    expected(:, 1) = [1.5719150468_wp, 2.6627141118_wp, 9.7754344987_wp, 26.007905077_wp, 11.534186465_wp, 160.98871024_wp]
    expected(:, 2) = [2.1806851443_wp, 4.6995378506_wp, 22.320757428_wp, 74.870832404_wp, 26.229837827_wp, 546.33360950_wp]
    error(2) = maxval([(abs(among_sizes_yin_sundaresan(bvk, eps, y(:, i))/expected(:, i) - 1), i=1, 2)])
    law = new_drag_law('cello')
    call law%find_factors(reynolds, eps, value)
    expected(:, 1) = [1.4186497460_wp, 2.6524057370_wp, 9.7288854937_wp, 26.045783057_wp, 11.500038263_wp, 172.02538143_wp]
    expected(:, 2) = [2.8074021875_wp, 5.2028775466_wp, 21.039538717_wp, 70.265100979_wp, 22.860329226_wp, 527.17455598_wp]
    error(3) = maxval([(abs(among_sizes_cello(value, eps, y(:, i), 1.125_wp)/expected(:, i) - 1), i=1, 2)])
    call check_value('sizes_beetstra', 100*error(1), 0.0_wp)
    call check_value('sizes_yin_sundaresan', 100*error(2), 0.0_wp)
    call check_value('sizes_cello', 100*error(3), 0.0_wp)
  end subroutine laws_among_sizes

  !> Minimum fluidization by a drag law, where it carries particles of 500 um and 2500 kg/m3 at a void fraction of 0.42 in
  !> air. The velocities expected were computed outside the program.
  subroutine fluidization()
    call check_umf('gidaspow', 0.2485206653_wp)
    call check_umf('beetstra', 0.2263216658_wp)
    call check_umf('tang', 0.1969866809_wp)
    call check_umf('syamlal_obrien', 0.3350884991_wp)
  end subroutine fluidization

  subroutine check_umf(law, expected)
    character(len=*), intent(in) :: law
    real(wp), intent(in) :: expected  !< [m/s]

    call check_value('umf_'//law, carried_velocity(law, 5.0e-4_wp, 2500.0_wp, 0.42_wp), expected)
  end subroutine check_umf

  !> Gas through a held bed, against Ergun's equation as it stands in textbooks: the largest relative error [%].
  subroutine packed_bed()
    real(wp), parameter :: d(6) = [1.0e-4_wp, 1.0e-4_wp, 5.0e-4_wp, 5.0e-4_wp, 1.0e-3_wp, 2.5e-3_wp]
    real(wp), parameter :: void(6) = [0.4_wp, 0.5_wp, 0.45_wp, 0.5_wp, 0.4_wp, 0.45_wp]
    real(wp), parameter :: velocity(6) = [0.05_wp, 0.1_wp, 0.5_wp, 1.0_wp, 1.0_wp, 0.1_wp]
    real(wp), parameter :: expected(6) = [76429.6875_wp, 54840.0_wp, 24263.37449_wp, 38400.0_wp, 34875.0_wp, 194.1069959_wp]
    real(wp) :: worst
    integer :: i

    worst = 0.0_wp
    do i = 1, 6
      worst = max(worst, abs(packed_gradient(comm, 'ergun', d(i), void(i), velocity(i))/expected(i) - 1))
    end do
    call check_value('packed_bed', 100*worst, 0.0_wp)
  end subroutine packed_bed

  !> The superficial slip of a suspension that gas carries, 75 um and 1500 kg/m3 at void fractions of 0.5, 0.7 and 0.9 in air: the
  !> largest relative error [%]. What is expected was computed outside the program, of the last laws by the law's own balance.
  subroutine settling()
    character(len=*), parameter :: rest(8) = [character(len=14) :: 'ergun', 'gidaspow_blend', 'syamlal_obrien', 'tenneti', &
                                              'di_felice', 'di_felice_sn', 'rong', 'cello']
    integer :: i

    call check_settling('gidaspow', [0.007651101658_wp, 0.03478696858_wp, 0.1399641041_wp])
    call check_settling('wen_yu', [0.009976396519_wp, 0.04608491449_wp, 0.1399641041_wp])
    call check_settling('beetstra', [0.006221354645_wp, 0.02546777258_wp, 0.09352106275_wp])
    call check_settling('tang', [0.006187002774_wp, 0.02510716135_wp, 0.08910756607_wp])
    call check_settling('koch_hill', [0.006379280337_wp, 0.02699658701_wp, 0.08950912938_wp])
    do i = 1, size(rest)
      call check_settling(trim(rest(i)))
    end do
  end subroutine settling

  subroutine check_settling(law, tabulated)
    character(len=*), intent(in) :: law
    real(wp), intent(in), optional :: tabulated(3)  !< [m/s]

    real(wp), parameter :: d = 7.5e-5_wp, solid_density = 1500.0_wp, void(3) = [0.5_wp, 0.7_wp, 0.9_wp]
    real(wp) :: worst, expected
    integer :: i

    worst = 0.0_wp
    do i = 1, 3
      expected = carried_velocity(law, d, solid_density, void(i))
      if (present(tabulated)) expected = tabulated(i)
      worst = max(worst, abs(settling_velocity(comm, law, d, solid_density, void(i))/expected - 1))
    end do
    call check_value('settling_'//law, 100*worst, 0.0_wp)
  end subroutine check_settling

end program verify_drag
