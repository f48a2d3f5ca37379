!> What Chung & Ooi, Granul. Matter 13 (2011) 643-656, show of their tests 5 and 6, read off their figures to three or four
!> figures (KratosMultiphysics, DEMApplication/test_examples/basic_benchmarks/paper_data), and their tests 1 and 2 by the
!> formulas of Hertz with which they compare.
!>
!> Test 5: abscissa v_t/(mu v_n); `slip` tangential velocity of the contact point afterwards, `spin` omega r afterwards, both
!> over mu v_n; of discrete elements with two materials and of finite elements. Test 6: abscissa 7/2 mu (1 + e) v_n/v_t;
!> `beta` minus the tangential velocity of the contact point afterwards over that before.
module chung_ooi
  use kinds, only: wp
  implicit none
  private

  !> Tests 1 and 2: largest overlap [um], largest force [N], duration [us] of glass, limestone, aluminium and magnesium
  !> alloy: delta = (5 m v^2/(4 k))^(2/5), k = 4/3 E sqrt(R), k delta^(3/2), 2.943276 delta/v.
  real(wp), parameter, public :: hertz_impacts(3, 4) = reshape([ &
    274.1127021_wp, 10696.88898_wp, 40.33946687_wp, 368.3040256_wp, 7108.24128_wp, 54.20101996_wp, &
    49.71717524_wp, 11369.85831_wp, 731.6568434_wp, 52.12328832_wp, 7232.681026_wp, 767.0661177_wp], [3, 4])
  real(wp), parameter, public :: steel_slip(2, 15) = reshape([ &
    0.06647_wp, -0.08_wp, 0.33233_wp, -0.28_wp, 0.67069_wp, -0.49333_wp, 1.00906_wp, -0.74667_wp, 1.33535_wp, -1.0_wp, &
    1.66163_wp, -1.26667_wp, 2.0_wp, -1.53333_wp, 2.35045_wp, -1.81333_wp, 2.99094_wp, -2.44_wp, 3.34139_wp, -2.69333_wp, &
    4.00604_wp, -2.78667_wp, 4.99698_wp, -2.0_wp, 6.0_wp, -1.01333_wp, 9.98792_wp, 3.01333_wp, 12.96073_wp, 6.01333_wp], [2, 15])
  real(wp), parameter, public :: polyethylene_slip(2, 15) = reshape([ &
    0.07855_wp, -0.08_wp, 0.34441_wp, -0.29333_wp, 0.67069_wp, -0.57333_wp, 0.99698_wp, -0.88_wp, 1.34743_wp, -1.12_wp, &
    1.67372_wp, -1.44_wp, 2.01208_wp, -1.76_wp, 2.32628_wp, -2.05333_wp, 2.99094_wp, -2.68_wp, 3.34139_wp, -2.94667_wp, &
    3.99396_wp, -2.93333_wp, 4.99698_wp, -2.0_wp, 5.98792_wp, -1.0_wp, 10.0_wp, 3.0_wp, 12.96073_wp, 6.01333_wp], [2, 15])
  real(wp), parameter, public :: steel_spin(2, 15) = reshape([ &
    0.0578_wp, -0.10552_wp, 0.3526_wp, -0.43012_wp, 0.68208_wp, -0.81966_wp, 0.99422_wp, -1.2498_wp, 1.34104_wp, -1.66369_wp, &
    1.68786_wp, -2.09381_wp, 2.0_wp, -2.52395_wp, 2.32948_wp, -2.97844_wp, 2.98844_wp, -3.90366_wp, 3.31792_wp, -4.2932_wp, &
    3.99422_wp, -4.83681_wp, 5.0_wp, -5.00677_wp, 6.00578_wp, -5.00622_wp, 10.01156_wp, -5.00406_wp, 20.0_wp, -4.99053_wp], [2, 15])
  real(wp), parameter, public :: polyethylene_spin(2, 15) = reshape([ &
    0.07514_wp, -0.09739_wp, 0.3526_wp, -0.43824_wp, 0.68208_wp, -0.90085_wp, 0.99422_wp, -1.33099_wp, 1.34104_wp, -1.76112_wp, &
    1.68786_wp, -2.2156_wp, 2.01734_wp, -2.67009_wp, 2.34682_wp, -3.11646_wp, 3.02312_wp, -4.04979_wp, 3.33526_wp, -4.45557_wp, &
    4.01156_wp, -4.93423_wp, 5.0_wp, -4.96617_wp, 6.00578_wp, -4.95751_wp, 9.99422_wp, -4.96347_wp, 20.0_wp, -4.94182_wp], [2, 15])
  real(wp), parameter, public :: aluminium_beta(2, 17) = reshape([ &
    0.17621_wp, -0.82003_wp, 0.35242_wp, -0.63347_wp, 0.55066_wp, -0.44472_wp, 0.77093_wp, -0.2428_wp, 0.96916_wp, -0.02771_wp, &
    1.18943_wp, 0.09739_wp, 1.45374_wp, 0.11934_wp, 1.74009_wp, 0.09959_wp, 2.09251_wp, 0.05789_wp, 2.48899_wp, 0.00521_wp, &
    2.99559_wp, -0.04966_wp, 3.63436_wp, -0.10014_wp, 4.51542_wp, -0.13964_wp, 5.7489_wp, -0.17476_wp, 7.81938_wp, -0.20768_wp, &
    11.89427_wp, -0.25816_wp, 24.00881_wp, -0.34156_wp], [2, 17])
  real(wp), parameter, public :: nylon_beta(2, 17) = reshape([ &
    0.17621_wp, -0.82442_wp, 0.37445_wp, -0.63786_wp, 0.57269_wp, -0.44252_wp, 0.7489_wp, -0.2428_wp, 0.96916_wp, -0.02551_wp, &
    1.18943_wp, 0.093_wp, 1.45374_wp, 0.11934_wp, 1.74009_wp, 0.11715_wp, 2.09251_wp, 0.0952_wp, 2.51101_wp, 0.05569_wp, &
    2.99559_wp, 0.00741_wp, 3.61233_wp, -0.05624_wp, 4.51542_wp, -0.11989_wp, 5.77093_wp, -0.1594_wp, 7.81938_wp, -0.1177_wp, &
    11.9163_wp, -0.11331_wp, 24.00881_wp, -0.1155_wp], [2, 17])
  real(wp), parameter, public :: finite_elements(2, 16) = reshape([ &
    0.2719_wp, -0.02667_wp, 0.5861_wp, -0.02667_wp, 0.87613_wp, -0.08_wp, 1.19033_wp, -0.21333_wp, 1.55287_wp, -0.37333_wp, &
    1.91541_wp, -0.62667_wp, 2.3141_wp, -0.94667_wp, 2.78549_wp, -1.25333_wp, 3.31722_wp, -1.52_wp, 3.96979_wp, -1.72_wp, &
    4.75529_wp, -1.70667_wp, 5.75831_wp, -1.2_wp, 7.12387_wp, 0.13333_wp, 9.11782_wp, 2.14667_wp, 12.3565_wp, 5.42667_wp, &
    12.96073_wp, 6.01333_wp], [2, 16])

end module chung_ooi
